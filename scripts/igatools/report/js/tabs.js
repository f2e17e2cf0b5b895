// The tabs: one panel at a time, chosen by mouse or by arrow keys. Without scripts all panels show, one below the other.

function setUpTabs() {
  const tabs = [...document.querySelectorAll('[role=tab]')];
  const panelOf = tab => document.getElementById(tab.getAttribute('aria-controls'));

  function choose(tab) {
    for (const other of tabs) {
      const isChosen = other === tab;
      other.setAttribute('aria-selected', isChosen);
      other.tabIndex = isChosen ? 0 : -1;
      panelOf(other).hidden = !isChosen;
    }
    document.dispatchEvent(new CustomEvent('panelshown', {detail: panelOf(tab).id}));
  }

  tabs.forEach((tab, number) => {
    tab.addEventListener('click', () => choose(tab));
    tab.addEventListener('keydown', event => {
      const last = tabs.length - 1;
      const after = number === last ? 0 : number + 1, before = number === 0 ? last : number - 1;
      const next = {ArrowRight: after, ArrowLeft: before, Home: 0, End: last}[event.key];
      if (next === undefined) return;
      event.preventDefault();
      choose(tabs[next]);
      tabs[next].focus();
    });
  });
  choose(tabs.find(tab => tab.id === 'tab-' + location.hash.slice(1)) || tabs[0]);
}
