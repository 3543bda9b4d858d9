// What    What mouse, keys and fingers do to a camera: {from, at, up, fov, ortho}, where fov is in degrees over the
//         picture's full height and ortho, above 0, its width in parallel rays. Every function returns another camera.
// Units   Shares of the picture's height for what is dragged (x to the right, y down), radians for what is turned.

export const add = (a, b) => a.map((x, i) => x + b[i]);
export const sub = (a, b) => a.map((x, i) => x - b[i]);
export const scale = (a, s) => a.map((x) => x * s);
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const cross = (a, b) => [
  a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a) => Math.hypot(a[0], a[1], a[2]);
export const unit = (a) => scale(a, 1 / length(a));

// About a unit axis (Rodrigues).
export function turn(v, axis, angle) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return add(add(scale(v, c), scale(cross(axis, v), s)), scale(axis, dot(axis, v) * (1 - c)));
}

export function basis(camera) {
  const forward = unit(sub(camera.at, camera.from));
  const right = unit(cross(forward, camera.up));
  return {forward, right, up: cross(right, forward)};
}

// The picture's height, in the plane through what the camera looks at.
export function heightAt(camera, aspect) {
  if (camera.ortho > 0) return camera.ortho / aspect;
  return 2 * length(sub(camera.at, camera.from)) * Math.tan(camera.fov * Math.PI / 360);
}

const CLOSEST_TO_POLE = 0.01;  // radians

// The angle by which a direction may be turned from `up` without passing a pole.
function limited(direction, up, angle) {
  const from_pole = Math.acos(Math.max(-1, Math.min(1, dot(unit(direction), up))));
  return Math.max(CLOSEST_TO_POLE - from_pole, Math.min(Math.PI - CLOSEST_TO_POLE - from_pole, angle));
}

export function orbit(camera, x, y) {
  const up = unit(camera.up), {right} = basis(camera);
  let away = sub(camera.from, camera.at);
  away = turn(away, right, -limited(away, up, -y));
  return {...camera, from: add(camera.at, turn(away, up, -x))};
}

export function look(camera, x, y) {
  const up = unit(camera.up), {right} = basis(camera);
  let ahead = sub(camera.at, camera.from);
  ahead = turn(ahead, right, -limited(ahead, up, y));
  return {...camera, at: add(camera.from, turn(ahead, up, -x))};
}

function moved(camera, by) {
  return {...camera, from: add(camera.from, by), at: add(camera.at, by)};
}

export function pan(camera, x, y, aspect) {
  const {right, up} = basis(camera), height = heightAt(camera, aspect);
  return moved(camera, add(scale(right, -x * height), scale(up, y * height)));
}

export function fly(camera, right_by, up_by, forward_by) {
  const {right, forward} = basis(camera);
  return moved(camera, add(add(scale(right, right_by), scale(unit(camera.up), up_by)), scale(forward, forward_by)));
}

// x and y: where the pointer is, from the picture's middle. What is there, in the plane through what the camera
// looks at, stays there.
export function zoom(camera, factor, x, y, aspect) {
  const {right, up} = basis(camera), height = heightAt(camera, aspect);
  const aside = add(scale(right, x * height), scale(up, -y * height));
  if (camera.ortho > 0) return {...moved(camera, scale(aside, 1 - factor)), ortho: camera.ortho * factor};
  const fixed = add(camera.at, aside);
  const towards = (p) => add(fixed, scale(sub(p, fixed), factor));
  return {...camera, from: towards(camera.from), at: towards(camera.at)};
}

// Turns about another point, which comes to the middle.
export function recentre(camera, point) {
  return moved(camera, sub(point, camera.at));
}

export function toggleOrtho(camera, aspect) {
  if (camera.ortho > 0) {
    const distance = camera.ortho / aspect / 2 / Math.tan(camera.fov * Math.PI / 360);
    return {...camera, ortho: 0, from: sub(camera.at, scale(basis(camera).forward, distance))};
  }
  return {...camera, ortho: heightAt(camera, aspect) * aspect};
}

const corners = (box) => [...Array(8).keys()].map((i) => [0, 1, 2].map((k) => box[(i >> k) & 1][k]));
const MARGIN = 1.05;

// All of the box, from where the camera is looking now.
export function frameAll(camera, box, aspect) {
  const at = scale(add(box[0], box[1]), 0.5);
  const {right, up, forward} = basis(camera);
  const tan = Math.tan(camera.fov * Math.PI / 360) / MARGIN;
  let distance = 0, half = 0;
  for (const corner of corners(box)) {
    const p = sub(corner, at), x = Math.abs(dot(p, right)), y = Math.abs(dot(p, up));
    distance = Math.max(distance, Math.max(x / aspect, y) / tan - dot(p, forward));
    half = Math.max(half, x, y * aspect);
  }
  if (!(distance > 0)) return recentre(camera, at);
  return {...camera, at, from: sub(at, scale(forward, distance)), ortho: camera.ortho > 0 ? 2 * MARGIN * half : 0};
}

// From the front, the right side or above, where `up` is an axis (or nearest to one).
export function fromSide(camera, side, box, aspect) {
  const k = [0, 1, 2].reduce((a, b) => (Math.abs(camera.up[b]) > Math.abs(camera.up[a]) ? b : a), 0);
  const sign = camera.up[k] < 0 ? -1 : 1;
  const axis = (i, s) => [0, 1, 2].map((j) => (j === i % 3 ? s : 0));
  const up = axis(k, sign), right = axis(k + 2, sign), front = cross(right, up);
  const away = {front, side: right, top: up}[side];
  const view = {...camera, up: side === 'top' ? scale(front, -1) : up, from: add(camera.at, away)};
  return {...frameAll(view, box, aspect), up: side === 'top' ? view.up : up};
}

const AXES = [[0, 1, 0], [0, 0, 1], [1, 0, 0], [0, -1, 0], [0, 0, -1], [-1, 0, 0]];
const axisOf = (camera) => AXES.findIndex((a) => dot(a, unit(camera.up)) > 0.9);

// Another direction is up, and the camera goes with it.
export function withUp(camera, up) {
  const now = unit(camera.up), axis = cross(now, up), sine = length(axis);
  const angle = Math.atan2(sine, dot(now, up));
  const about = sine > 1e-9 ? scale(axis, 1 / sine) : basis(camera).right;
  return {...camera, up, from: add(camera.at, turn(sub(camera.from, camera.at), about, angle))};
}

export function nextUp(camera) {
  return withUp(camera, AXES[(axisOf(camera) + 1) % AXES.length]);
}

// The axis that is up, as text, or nothing.
export function upAxis(camera) {
  return AXES[axisOf(camera)]?.join(',') ?? '';
}

// With no more digits than can be seen: a millionth of the distance, and seven digits of the rest.
export function rounded(camera) {
  const digits = 6 - Math.floor(Math.log10(length(sub(camera.at, camera.from))));
  if (!(digits >= 0 && digits <= 100)) return camera;
  const short = (x) => Number(x.toFixed(digits)), seven = (x) => Number(x.toPrecision(7));
  return {from: camera.from.map(short), at: camera.at.map(short), up: camera.up.map((x) => Number(x.toFixed(7))),
          fov: seven(camera.fov), ortho: seven(camera.ortho)};
}

// Where a point is seen: x, y from -1 to 1, and how far ahead it is.
export function project(camera, aspect, view = basis(camera)) {
  const h = camera.ortho > 0 ? camera.ortho / aspect / 2 : Math.tan(camera.fov * Math.PI / 360);
  return (p) => {
    const d = sub(p, camera.from), ahead = dot(d, view.forward);
    const by = camera.ortho > 0 ? h : h * ahead;
    return [dot(d, view.right) / (by * aspect), dot(d, view.up) / by, ahead];
  };
}
