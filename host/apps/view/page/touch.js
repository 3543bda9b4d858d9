// What    Fingers: one orbits, two pan, and zoom where they part; a tap is a click.
import * as camera from './camera.js';

const TAP_PIXELS = 10, TAP_TIME = 400;
const ORBIT = Math.PI;

export class Touches {
  constructor(view, clicked) {
    Object.assign(this, {view, clicked, fingers: new Map(), tap: null});
  }

  down(e, canvas) {
    canvas.setPointerCapture(e.pointerId);
    this.fingers.set(e.pointerId, [e.clientX, e.clientY]);
    this.tap = this.fingers.size === 1 ? {at: e.timeStamp, far: 0} : null;
    e.preventDefault();
  }

  middle() {
    const all = [...this.fingers.values()];
    const sum = all.reduce((a, b) => [a[0] + b[0], a[1] + b[1]], [0, 0]);
    const centre = sum.map((x) => x / all.length);
    return {centre, spread: all.length > 1 ? Math.hypot(all[0][0] - all[1][0], all[0][1] - all[1][1]) : 0};
  }

  move(e) {
    if (!this.fingers.has(e.pointerId)) return;
    const before = this.middle();
    this.fingers.set(e.pointerId, [e.clientX, e.clientY]);
    const after = this.middle(), {view} = this, height = view.height;
    const x = (after.centre[0] - before.centre[0]) / height, y = (after.centre[1] - before.centre[1]) / height;
    if (this.tap) this.tap.far += Math.hypot(x, y) * height;
    if (this.fingers.size === 1) return view.change(camera.orbit(view.camera, x * ORBIT, y * ORBIT), e.timeStamp);
    const [px, py] = view.place({clientX: after.centre[0], clientY: after.centre[1]});
    const moved = camera.pan(view.camera, x, y, view.aspect);
    const factor = before.spread > 0 && after.spread > 0 ? before.spread / after.spread : 1;
    view.change(camera.zoom(moved, factor, (px - 0.5) * view.aspect, py - 0.5, view.aspect), e.timeStamp);
  }

  up(e) {
    this.fingers.delete(e.pointerId);
    const tap = this.tap;
    this.tap = null;
    if (tap && e.type === 'pointerup' && tap.far < TAP_PIXELS && e.timeStamp - tap.at < TAP_TIME)
      this.clicked(...this.view.place(e));
  }
}
