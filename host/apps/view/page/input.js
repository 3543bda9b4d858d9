// What    Mouse, keys and fingers: what they do to the view.
import * as camera from './camera.js';

const ORBIT = Math.PI;         // radians for a drag over the picture's height
const LOOK = Math.PI / 2;
const WHEEL = 0.0012;          // of a factor, for a pixel of the wheel
const CLICK_PIXELS = 4, CLICK_TIME = 500, DOUBLE_TIME = 350;
const TAP_PIXELS = 10, TAP_TIME = 400;
const FLIGHT = 0.8;            // distances to what is looked at, in a second
const FAST = 4;
const STEP = 1 / 24;           // of the picture's height, for an arrow key
const ZOOM = 1.1;              // for plus and minus
const ARROWS = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};

const FLY = {KeyW: [0, 0, 1], KeyS: [0, 0, -1], KeyA: [-1, 0, 0], KeyD: [1, 0, 0], KeyQ: [0, -1, 0], KeyE: [0, 1, 0]};

// Fingers: one orbits, two pan, and zoom where they part; a tap is a click.
class Touches {
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

// view: camera, box, aspect, height, change(camera), place(event), click(x, y), recentre(x, y), reset(), and commands by
// name for keys: help, panel, copy.
export class InputController {
  constructor(canvas, view) {
    Object.assign(this, {canvas, view, down: null, keys: new Set(), fast: false, lastClick: null});
    const touches = new Touches(view, (x, y) => this.clicked(x, y));
    const on = (name, handler) => canvas.addEventListener(name, handler);
    on('pointerdown', (e) => e.pointerType === 'touch' ? touches.down(e, canvas) : this.press(e));
    on('pointermove', (e) => e.pointerType === 'touch' ? touches.move(e) : this.drag(e));
    on('pointerup', (e) => e.pointerType === 'touch' ? touches.up(e) : this.release(e));
    on('pointercancel', (e) => e.pointerType === 'touch' ? touches.up(e) : (this.down = null));
    on('contextmenu', (e) => e.preventDefault());
    canvas.addEventListener('wheel', (e) => this.wheel(e), {passive: false});
    addEventListener('keydown', (e) => this.key(e));
    addEventListener('keyup', (e) => this.up(e));
    addEventListener('blur', () => this.keys.clear());
  }

  press(e) {
    this.canvas.focus();
    this.canvas.setPointerCapture(e.pointerId);
    const pans = e.button === 1 || e.shiftKey, looks = e.button === 2 || this.keys.size > 0;
    this.down = {x: e.clientX, y: e.clientY, at: e.timeStamp, far: 0, what: looks ? 'look' : pans ? 'pan' : 'orbit'};
    e.preventDefault();
  }

  drag(e) {
    const d = this.down;
    if (!d) return;
    const x = (e.clientX - d.x) / this.view.height, y = (e.clientY - d.y) / this.view.height;
    d.far += Math.hypot(e.clientX - d.x, e.clientY - d.y);
    Object.assign(d, {x: e.clientX, y: e.clientY});
    if (d.far < CLICK_PIXELS) return;
    const what = this.keys.size > 0 ? 'look' : d.what, now = this.view.camera;
    if (what === 'pan') this.view.change(camera.pan(now, x, y, this.view.aspect), e.timeStamp);
    else if (what === 'look') this.view.change(camera.look(now, -x * LOOK, -y * LOOK), e.timeStamp);
    else this.view.change(camera.orbit(now, x * ORBIT, y * ORBIT), e.timeStamp);
  }

  release(e) {
    const d = this.down;
    this.down = null;
    if (d && d.what === 'orbit' && d.far < CLICK_PIXELS && e.timeStamp - d.at < CLICK_TIME)
      this.clicked(...this.view.place(e));
  }

  clicked(x, y) {
    const now = performance.now(), last = this.lastClick;
    this.lastClick = {x, y, now};
    if (last && now - last.now < DOUBLE_TIME && Math.hypot(x - last.x, y - last.y) < 0.02) this.view.recentre(x, y);
    else this.view.click(x, y);
  }

  wheel(e) {
    e.preventDefault();
    const pixels = e.deltaY * (e.deltaMode === 1 ? 33 : e.deltaMode === 2 ? 400 : 1);
    const [x, y] = this.view.place(e);
    const factor = Math.exp(Math.max(-400, Math.min(400, pixels)) * WHEEL);
    this.view.change(camera.zoom(this.view.camera, factor, (x - 0.5) * this.view.aspect, y - 0.5, this.view.aspect),
                     e.timeStamp);
  }

  key(e) {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    if (e.code === 'Escape') return this.view.escape() && e.preventDefault();
    if (/^(INPUT|SELECT|TEXTAREA)$/.test(e.target.tagName)) return;
    if (document.querySelector('dialog:modal') && e.code !== 'KeyH') return;
    if (this.step(e)) return e.preventDefault();
    this.fast = e.shiftKey;
    if (FLY[e.code]) return void this.keys.add(e.code);
    const {view} = this, now = view.camera;
    const action = {
      KeyF: () => view.box && view.change(camera.frameAll(now, view.box, view.aspect)),
      KeyR: () => view.reset(),
      KeyU: () => view.change(camera.nextUp(now)),
      KeyO: () => view.change(camera.toggleOrtho(now, view.aspect)),
      Digit1: () => this.side('front'), Numpad1: () => this.side('front'),
      Digit3: () => this.side('side'), Numpad3: () => this.side('side'),
      Digit7: () => this.side('top'), Numpad7: () => this.side('top'),
      KeyH: view.help, KeyP: view.panel, KeyC: view.copy,
    }[e.code];
    if (action) action();
  }

  // Arrow keys, which scroll what else has the focus, and plus and minus, wherever the keyboard has them.
  step(e) {
    const {view} = this, arrow = e.target.closest('#details, dialog') ? null : ARROWS[e.key];
    if (!view.camera) return false;
    if (arrow) {
      const [x, y] = arrow.map((v) => v * STEP), now = view.camera;
      view.change(e.shiftKey ? camera.pan(now, x, y, view.aspect) : camera.orbit(now, x * ORBIT, y * ORBIT), e.timeStamp);
      return true;
    }
    const factor = {'+': 1 / ZOOM, '=': 1 / ZOOM, '-': ZOOM, '_': ZOOM}[e.key];
    if (factor) view.change(camera.zoom(view.camera, factor, 0, 0, view.aspect), e.timeStamp);
    return Boolean(factor);
  }

  up(e) {
    this.fast = e.shiftKey;
    this.keys.delete(e.code);
  }

  side(name) {
    const {view} = this;
    if (view.box) view.change(camera.fromSide(view.camera, name, view.box, view.aspect));
  }

  // Once for each frame of the screen.
  fly(seconds) {
    if (!this.keys.size) return;
    const by = [0, 0, 0];
    for (const key of this.keys) FLY[key].forEach((x, k) => { by[k] += x; });
    const now = this.view.camera, size = this.view.box ? camera.length(camera.sub(this.view.box[1], this.view.box[0])) / 4 : 1;
    const reach = Math.min(camera.length(camera.sub(now.at, now.from)), size);
    const step = reach * FLIGHT * seconds * (this.fast ? FAST : 1);
    this.view.change(camera.fly(now, ...camera.scale(by, step)));
  }
}
