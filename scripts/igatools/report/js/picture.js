// The picture to be saved: the view as drawn, with its colour scale and what it shows.

function pictureWithScale(view, colouring, text) {
  const unit = view.width / view.clientWidth;  // of the screen, in pixels of the picture
  const side = colouring ? 170 * unit : 0, foot = 40 * unit;
  const picture = document.createElement('canvas');
  picture.width = view.width + side;
  picture.height = view.height + foot;
  const pen = picture.getContext('2d');
  const style = getComputedStyle(document.documentElement);
  pen.fillStyle = style.getPropertyValue('--stage');
  pen.fillRect(0, 0, picture.width, picture.height);
  pen.drawImage(view, side, 0);
  pen.fillStyle = style.getPropertyValue('--ink');
  pen.font = `${14 * unit}px sans-serif`;
  pen.fillText(text, 14 * unit, picture.height - 14 * unit, picture.width - 28 * unit);
  if (colouring) drawScale(pen, colouring, unit);
  return picture;
}

function drawScale(pen, colouring, unit) {
  const left = 14 * unit, top = 64 * unit, height = 260 * unit;
  const lines = colouring.title.split(/(?= largest)|(?= \[)/);
  lines.forEach((line, number) => pen.fillText(line.trim(), left, (26 + 18 * number) * unit));
  const ink = pen.fillStyle;
  for (let row = 0; row < height; ++row) {
    pen.fillStyle = `rgb(${colourOf(1 - row / height).map(Math.round)})`;
    pen.fillRect(left, top + row, 18 * unit, 1);
  }
  pen.fillStyle = ink;
  for (const share of [0, 0.2, 0.4, 0.6, 0.8, 1])
    pen.fillText(shortNumber(share * colouring.largest), left + 26 * unit, top + (1 - share) * height + 5 * unit);
}
