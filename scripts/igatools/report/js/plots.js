// Legends of plots: a chosen name brings its curve to the front, the others fade.

function setUpPlots() {
  for (const plot of document.querySelectorAll('.plot')) {
    const buttons = [...plot.querySelectorAll('.legend button')];
    for (const button of buttons) {
      button.addEventListener('click', () => {
        const isChosen = button.getAttribute('aria-pressed') !== 'true';
        for (const other of buttons) other.setAttribute('aria-pressed', isChosen && other === button);
        plot.classList.toggle('chosen', isChosen);
        for (const curve of plot.querySelectorAll('.curve'))
          curve.classList.toggle('is-chosen', isChosen && curve.dataset.curve === button.dataset.curve);
      });
    }
  }
}

function setUpCopying() {
  const button = document.getElementById('copy');
  if (!button) return;
  const commands = document.getElementById('commands');
  const said = document.getElementById('copied');
  button.addEventListener('click', async () => {
    try {
      await navigator.clipboard.writeText(commands.textContent);
      said.textContent = 'Copied.';
    } catch {
      getSelection().selectAllChildren(commands);
      said.textContent = 'Selected; copy with Ctrl+C.';
    }
  });
}
