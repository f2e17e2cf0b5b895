// Colours of values: viridis, which also rises evenly in brightness, as a texture for the surface and as a bar with numbers.

const PALETTE = [[68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141],
  [42, 120, 142], [33, 145, 140], [34, 168, 132], [68, 191, 112], [122, 209, 81],
  [189, 223, 38], [253, 231, 37]];
const TEXELS = 256;

function colourOf(share) {
  const place = Math.min(Math.max(share, 0), 1) * (PALETTE.length - 1);
  const below = Math.min(Math.floor(place), PALETTE.length - 2);
  return PALETTE[below].map((value, k) => value + (place - below) * (PALETTE[below + 1][k] - value));
}

function paletteTexture() {
  const texels = new Uint8Array(3 * TEXELS);
  for (let k = 0; k < TEXELS; ++k) texels.set(colourOf(k / (TEXELS - 1)), 3 * k);
  const texture = new THREE.DataTexture(texels, TEXELS, 1, THREE.RGBFormat);
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

function shortNumber(value) {
  if (value === 0) return '0';
  const size = Math.abs(value);
  return size >= 1e5 || size < 1e-3 ? value.toExponential(2) : String(Number(value.toPrecision(3)));
}

// Shows the bar for values 0 … largest; `colouring` null hides it.
function showBar(colouring) {
  const bar = document.getElementById('bar');
  bar.hidden = !colouring;
  if (!colouring) return;
  document.getElementById('bar-title').textContent = colouring.title;
  document.getElementById('bar-note').textContent = colouring.note;
  const stops = PALETTE.map(colour => `rgb(${colour})`).join(',');
  document.getElementById('bar-colours').style.background = `linear-gradient(to top, ${stops})`;
  const ticks = document.getElementById('bar-ticks');
  ticks.replaceChildren(...[0, 0.2, 0.4, 0.6, 0.8, 1].map(share => {
    const tick = document.createElement('span');
    tick.style.bottom = `${100 * share}%`;
    tick.textContent = shortNumber(share * colouring.largest);
    return tick;
  }));
}
