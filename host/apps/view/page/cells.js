// What    The cells of the kd-tree, as lines over the picture.
import {project} from './camera.js';

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
