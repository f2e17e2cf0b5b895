// Starts the page; the 3-D view when its tab is shown for the first time.

function startView(data) {
  let view;
  try {
    view = new View(element('canvas'), data);
  } catch (error) {
    const note = document.createElement('p');
    note.className = 'note';
    note.textContent = `This browser cannot draw the 3-D view (WebGL): ${error.message}`;
    document.querySelector('.view').replaceWith(note);
    return;
  }
  const controls = new Controls(view);
  if (data.steps.length && !matchMedia('(prefers-reduced-motion: reduce)').matches) controls.play(true);
}

const scene = JSON.parse(element('scene').textContent);
if (scene) {
  let isStarted = false;
  document.addEventListener('panelshown', event => {
    if (event.detail !== 'panel-view' || isStarted) return;
    isStarted = true;
    startView(scene);
  });
}
setUpPlots();
setUpCopying();
setUpTabs();
