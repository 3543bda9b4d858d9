// What    The picture on the screen, as large as the window, or as kdray was asked for; and the lines over it, which are the
//         cells of the kd-tree.
import {project} from './camera.js';

const MOST_PIXELS = 4 << 20;

export class Screen {
  constructor(picture, lines, viewport) {
    Object.assign(this, {picture, lines, viewport, fixed: null, look: 0, shown: 0});
    this.context = picture.getContext('2d', {alpha: false});
  }

  // Pixels of the picture, across and down. `fixed`: what kdray's --size says.
  size() {
    if (this.fixed) return this.fixed;
    const {width, height} = this.viewport.getBoundingClientRect();
    let by = Math.min(window.devicePixelRatio || 1, 2);
    if (width * height * by * by > MOST_PIXELS) by = Math.min(1, Math.sqrt(MOST_PIXELS / (width * height)));
    return [Math.max(16, Math.floor(width * by)), Math.max(16, Math.floor(height * by))];
  }

  get aspect() {
    const [width, height] = this.size();
    return width / height;
  }

  // The canvases, in the middle of the window; what is on them stays.
  layout() {
    const [width, height] = this.size();
    const box = this.viewport.getBoundingClientRect();
    const by = this.fixed ? Math.min(1, box.width / width, box.height / height)
                          : Math.min(box.width / width, box.height / height);
    if (this.picture.width !== width || this.picture.height !== height) {
      const old = this.shown ? createImageBitmap(this.picture) : null;
      this.picture.width = this.lines.width = width;
      this.picture.height = this.lines.height = height;
      this.context.fillStyle = '#14161a';
      this.context.fillRect(0, 0, width, height);
      old?.then((bitmap) => this.context.drawImage(bitmap, 0, 0, width, height));
    }
    for (const canvas of [this.picture, this.lines]) {
      canvas.style.width = `${width * by}px`;
      canvas.style.height = `${height * by}px`;
    }
  }

  // One that is older than what is there already is not shown.
  async show(frame, blob) {
    const bitmap = await createImageBitmap(blob, {colorSpaceConversion: 'none'});
    if (frame.look >= this.look && frame.frame > this.shown) {
      this.look = frame.look;
      this.shown = frame.frame;
      this.context.imageSmoothingQuality = 'medium';
      this.context.drawImage(bitmap, 0, 0, this.picture.width, this.picture.height);
    }
    bitmap.close();
  }

  // In shares of width and height from the upper left corner.
  place(event) {
    const box = this.picture.getBoundingClientRect();
    return [(event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height];
  }

  // Pixels of the screen for one picture's height.
  get height() { return this.picture.getBoundingClientRect().height; }
}

const NEAR = 1e-6;  // of the distance to what is looked at: what is behind the eye is cut off there
const EDGES = [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

const corner = (box, i) => [box[i & 1 ? 3 : 0], box[i & 2 ? 4 : 1], box[i & 4 ? 5 : 2]];
const between = (a, b, s) => a.map((x, k) => x + (b[k] - x) * s);

function segment(path, seen, a, b, near, perspective, width, height) {
  if (perspective) {
    const [za, zb] = [seen(a)[2], seen(b)[2]];
    if (za < near && zb < near) return;
    if (za < near) a = between(a, b, (near - za) / (zb - za));
    else if (zb < near) b = between(b, a, (near - zb) / (za - zb));
  }
  const [p, q] = [seen(a), seen(b)];
  path.moveTo((p[0] + 1) / 2 * width, (1 - p[1]) / 2 * height);
  path.lineTo((q[0] + 1) / 2 * width, (1 - q[1]) / 2 * height);
}

export function drawCells(canvas, boxes, camera, aspect) {
  const context = canvas.getContext('2d'), {width, height} = canvas;
  context.clearRect(0, 0, width, height);
  if (!boxes.length) return;
  const seen = project(camera, aspect), path = new Path2D();
  const near = NEAR * Math.hypot(...camera.at.map((x, k) => x - camera.from[k]));
  for (const box of boxes)
    for (const [i, j] of EDGES) segment(path, seen, corner(box, i), corner(box, j), near, camera.ortho <= 0, width, height);
  context.strokeStyle = `rgba(120, 200, 255, ${Math.max(0.12, Math.min(0.8, 12 / Math.sqrt(boxes.length)))})`;
  context.lineWidth = Math.max(1, width / 1600);
  context.stroke(path);
}
