// Controls of the 3-D view: choice and play of the motion, colours, spans, cut, view.

const PERIOD = 1.6;       // seconds of one swing
const FRAME_RATE = 12;    // steps per second of a run over time
const TURN = Math.PI / 18, ZOOM = 1.15;

class Controls {
  constructor(view) {
    this.view = view;
    this.kind = view.data.kind;
    this.diagonal = 2 * view.eye.radius;
    this.isPlaying = false;
    this.phase = this.kind === 'time' ? 0 : 0.25;  // of the swing; at rest the full motion is shown
    this.setUpMotion();
    this.setUpShow();
    this.setUpCut();
    this.setUpEye();
    element('save').addEventListener('click', () => this.savePicture());
    element('canvas').addEventListener('keydown', event => this.key(event));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => view.takeColours());
    this.choose(view.data.steps.length ? 0 : -1);
  }

  setUpMotion() {
    const {steps} = this.view.data;
    element('shapes').hidden = steps.length === 0;
    element('shape-name').textContent = {swing: 'Mode', time: 'Time', load: 'Load'}[this.kind];
    element('shape').append(...steps.map((step, number) => new Option(step.label, number)), new Option('Part as given', -1));
    element('shape').addEventListener('change', event => this.choose(Number(event.target.value)));
    for (const id of ['before', 'after']) element(id).hidden = steps.length < 2;
    element('before').addEventListener('click', () => this.chooseBeside(-1));
    element('after').addEventListener('click', () => this.chooseBeside(1));
    element('play').addEventListener('click', () => this.play(!this.isPlaying));
    element('amount-row').hidden = this.kind === 'time';
    element('amount').addEventListener('input', () => { this.isTrue = false; this.show(); });
    element('true-size').hidden = this.kind !== 'load';
    element('true-size').addEventListener('click', () => { this.isTrue = true; this.show(); });
    this.isTrue = this.kind === 'time' || (this.kind === 'load' && steps.length > 0 && steps[0].largest > 0.03 * this.diagonal);
  }

  setUpShow() {
    const {steps, spans} = this.view.data;
    const colours = [['', 'nothing']];
    if (steps.length) colours.unshift(['displacement', 'displacement']);
    if (steps.some(step => step.von_mises)) colours.unshift(['von_mises', 'von Mises stress']);
    element('colour').append(...colours.map(([value, name]) => new Option(name, value)));
    element('colour').addEventListener('change', () => this.colour());
    element('show-surface').addEventListener('change', event => {
      this.view.surface.mesh.visible = event.target.checked;
      this.view.draw();
    });
    ['interior', 'trimmed'].forEach((kind, place) => {
      const box = element(`show-${kind}`);
      box.disabled = !spans;
      const name = kind[0].toUpperCase() + kind.slice(1);
      if (spans) element(`${kind}-name`).textContent = `${name} spans (${spans.counts[place].toLocaleString('en')})`;
      const show = () => { if (spans) this.view.lines[kind].visible = box.checked; this.view.draw(); };
      box.addEventListener('change', show);
      if (spans && !steps.length) { box.checked = true; show(); }
    });
  }

  setUpCut() {
    const cut = () => {
      const axis = element('cut').value;
      element('cut-row').hidden = !axis;
      this.view.cut(axis, Number(element('cut-place').value) / 100);
    };
    element('cut').addEventListener('change', cut);
    element('cut-place').addEventListener('input', cut);
  }

  setUpEye() {
    for (const button of document.querySelectorAll('[data-turn]'))
      button.addEventListener('click', () => this.turn(button.dataset.turn));
    for (const button of document.querySelectorAll('[data-view]')) {
      button.addEventListener('click', () => {
        if (button.dataset.view === 'home') this.view.eye.goHome(); else this.view.eye.lookFrom(button.dataset.view);
        this.view.draw();
      });
    }
    const canvas = element('canvas');
    canvas.addEventListener('pointerdown', event => canvas.setPointerCapture(event.pointerId));
    canvas.addEventListener('pointermove', event => {
      if (!canvas.hasPointerCapture(event.pointerId)) return;
      const x = event.movementX / canvas.clientHeight, y = event.movementY / canvas.clientHeight;
      if (event.shiftKey || event.buttons > 1) this.view.eye.shift(x, -y);
      else this.view.eye.rotate(-4 * x, 4 * y);
      this.view.draw();
    });
    canvas.addEventListener('contextmenu', event => event.preventDefault());
    canvas.addEventListener('wheel', event => {
      event.preventDefault();
      this.view.eye.zoom(Math.exp(0.001 * event.deltaY));
      this.view.draw();
    }, {passive: false});
  }

  turn(where) {
    const eye = this.view.eye;
    const turns = {left: [-TURN, 0], right: [TURN, 0], up: [0, TURN], down: [0, -TURN]};
    if (turns[where]) eye.rotate(...turns[where]);
    else eye.zoom(where === 'in' ? 1 / ZOOM : ZOOM);
    this.view.draw();
  }

  key(event) {
    const arrows = {ArrowLeft: 'left', ArrowRight: 'right', ArrowUp: 'up', ArrowDown: 'down'};
    const shifts = {ArrowLeft: [-0.05, 0], ArrowRight: [0.05, 0], ArrowUp: [0, 0.05], ArrowDown: [0, -0.05]};
    const others = {'+': () => this.turn('in'), '=': () => this.turn('in'), '-': () => this.turn('out'),
      ' ': () => this.play(!this.isPlaying),
      PageUp: () => this.chooseBeside(-1), PageDown: () => this.chooseBeside(1), Home: () => this.view.eye.goHome()};
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (arrows[event.key] && event.shiftKey) this.view.eye.shift(...shifts[event.key]);
    else if (arrows[event.key]) this.turn(arrows[event.key]);
    else if (others[event.key]) others[event.key]();
    else return;
    event.preventDefault();
    this.view.draw();
  }

  choose(number) {
    this.number = number;
    element('shape').value = number;
    this.view.chooseStep(number);
    this.colour();
    this.show();
  }

  chooseBeside(by) {
    const count = this.view.data.steps.length;
    if (count) this.choose((Math.max(this.number, 0) + by + count) % count);
  }

  colour() {
    this.colouring = this.view.colourBy(element('colour').value);
    showBar(this.colouring);
  }

  // Largest displacement to be drawn, in units of length.
  fullSize() {
    return this.isTrue ? this.view.largest : Number(element('amount').value) / 100 * this.diagonal;
  }

  show() {
    const full = this.view.step ? this.fullSize() : 0;
    this.view.setSize(full * this.shareNow());
    if (!this.isPlaying) this.say();
  }

  // Of the full motion.
  shareNow() {
    if (this.kind === 'swing') return Math.sin(2 * Math.PI * this.phase);
    return this.kind === 'load' && this.isPlaying ? 0.5 - 0.5 * Math.cos(2 * Math.PI * this.phase) : 1;
  }

  whatIsShown() {
    const {step, data} = this.view;
    if (!step) return 'The part as given.';
    if (this.kind === 'swing') return `${step.label}. A mode has a shape but no size: choose how large it is drawn.`;
    const largest = `${shortNumber(step.largest)} ${data.units.length}`.trim();
    const size = this.isTrue || !step.largest ? 'in true size' : `${shortNumber(this.fullSize() / step.largest)} times as large`;
    return `${step.label}. Largest displacement ${largest}, drawn ${size}.`;
  }

  say() {
    const text = this.whatIsShown();
    element('said').textContent = text;
    element('canvas').setAttribute('aria-label', text);
  }

  play(isPlaying) {
    this.isPlaying = isPlaying && this.view.step !== null;
    element('play').textContent = this.isPlaying ? 'Pause' : 'Play';
    element('play').setAttribute('aria-pressed', this.isPlaying);
    if (!this.isPlaying) return this.say();
    let last = performance.now();
    const next = now => {
      if (!this.isPlaying) return;
      this.advance((now - last) / 1000);
      last = now;
      requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
  }

  advance(seconds) {
    if (this.kind === 'time') {
      this.phase += seconds * FRAME_RATE;
      const steps = Math.floor(this.phase);
      this.phase -= steps;
      if (steps > 0) this.chooseBeside(1);
    } else {
      this.phase = (this.phase + seconds / PERIOD) % 1;
      this.show();
    }
  }

  savePicture() {
    this.view.drawNow();
    const link = document.createElement('a');
    const words = [`${document.title}.`, this.whatIsShown(), this.colouring ? this.colouring.note : ''].join(' ');
    link.href = pictureWithScale(this.view.canvas, this.colouring, words).toDataURL('image/png');
    link.download = 'view.png';
    link.click();
  }
}

function element(id) {
  return document.getElementById(id);
}
