// What    The page of kdray view: puts the parts together. A view is a camera and settings; whenever it changes kdray
//         gets a look, at most one for each frame of the screen, and another one when it has come to rest.
import * as address from './address.js';
import {rounded, upAxis, withUp} from './camera.js';
import {Controls, showPicked} from './controls.js';
import {InputController} from './input.js';
import {Link} from './link.js';
import {drawCells, Screen} from './screen.js';
import {showOwners, Strip} from './strip.js';

const REST = 140;  // milliseconds without a change
const byId = (id) => document.getElementById(id);

const screen = new Screen(byId('picture'), byId('lines'), byId('viewport'));
const strip = new Strip(byId('figures'), byId('details'), byId('more'));
const state = {
  scene: null, camera: null, number: 0, pick: 0, wanted: address.scene(), changed: false, moving: false, changedAt: 0, picks: new Map(), boxes: [],
  command: '', png: null, sent: new Map(), latencies: [], frames: 0, final: null, inputAt: 0, error: '', resizing: 0,
};

function show(id, text) {
  byId(id).textContent = text;
  byId(id).hidden = !text;
}

// ---- What is wanted

function viewRequest() {
  const [width, height] = screen.size();
  return {scene: state.scene.scene, camera: state.camera, width, height, ...controls.values()};
}

// `at`: the time of the input, for the latency of its frame.
function change(camera, at = performance.now()) {
  state.camera = camera;
  state.changed = state.moving = true;
  state.changedAt = performance.now();
  if (!state.inputAt) state.inputAt = at;
  byId('mark').hidden = true;
  byId('up').value = upAxis(camera);
  drawCells(screen.lines, state.boxes, state.camera, screen.aspect);
}

function ask(moving) {
  state.number += 1;
  if (moving) state.sent.set(state.number, state.inputAt);
  state.inputAt = 0;
  state.changed = false;
  state.command = '';
  state.png = state.final = null;
  byId('copy').disabled = byId('save').disabled = true;
  link.send({type: 'look', number: state.number, moving, sight: viewRequest()});
}

// Settings have no way in between: the picture at rest is what is wanted.
function settle() {
  if (!state.scene) return;
  state.moving = false;
  ask(false);
}

let last = performance.now();
function tick(now) {
  input.fly(Math.min(0.1, (now - last) / 1000));
  last = now;
  if (state.scene && link.open) {
    if (state.changed) ask(true);
    else if (state.moving && now - state.changedAt > REST) {
      const isFirst = state.camera === state.scene.camera;
      if (!isFirst) state.camera = rounded(state.camera);
      settle();
      address.keep(isFirst ? null : state.camera, state.scene.scene);
    }
  }
  requestAnimationFrame(tick);
}

// ---- Messages of kdray

function handleScene(scene) {
  const other = state.scene?.scene !== scene.scene, first = !state.scene;
  // A connection begins with the first scene.
  if (scene.scene !== state.wanted && state.wanted < scene.names.length) {
    state.camera ??= scene.camera;
    return askScene(state.wanted);
  }
  state.scene = scene;
  state.wanted = scene.scene;
  state.error = '';
  show('problem', '');
  screen.fixed = scene.size;
  if (other) {
    state.camera = (first && address.scene() === scene.scene ? address.camera() : null) ?? scene.camera;
    controls.begin(scene);
    byId('up').value = upAxis(state.camera);
    for (const warning of scene.warnings) console.info('kdray: ' + warning);
  }
  controls.showReading(scene);
  document.title = `${scene.names[scene.scene]} – kdray view`;
  byId('title').textContent = scene.names[scene.scene];
  byId('scene-row').hidden = scene.names.length < 2;
  byId('scene').replaceChildren(...scene.names.map((name, i) => new Option(name, String(i))));
  byId('scene').value = String(scene.scene);
  screen.look = screen.shown = 0;
  screen.layout();
  askCells();
  settle();
}

// A look at another scene is answered by a message about that scene, with its camera.
function askScene(number) {
  state.wanted = number;
  const [width, height] = screen.size();
  const request = {scene: number, camera: state.camera, width, height, ...controls.values()};
  link.send({type: 'look', number: ++state.number, moving: false, sight: request});
}

async function handleFrame(frame, picture) {
  try {
    await screen.show(frame, picture);
  } finally {
    link.send({type: 'shown', frame: frame.frame});
  }
  state.frames += 1;
  const inputAt = state.sent.get(frame.look);
  let latency = 0;
  if (frame.kind === 'moving' && inputAt) {
    latency = performance.now() - inputAt;
    state.latencies.push(latency);
    if (state.latencies.length > 1000) state.latencies.shift();
  }
  for (const number of state.sent.keys()) if (number <= frame.look) state.sent.delete(number);
  if (frame.figures) strip.show(frame, latency);
  byId('owners').hidden = controls.values().channel !== 'queue';
  if (frame.figures && !byId('owners').hidden) showOwners(byId('owners'), frame.figures);
  if (frame.look !== state.number) return;
  if (state.error === 'look') show('problem', '');
  if (frame.kind === 'final') {
    state.final = frame;
    state.png = picture;
    state.command = frame.command ?? '';
    byId('copy').disabled = !state.command;
    byId('save').disabled = false;
  }
}

function handlePicked(message) {
  const then = state.picks.get(message.number);
  state.picks.delete(message.number);
  then?.(message);
}

function receive(message, picture) {
  const handle = {
    scene: handleScene, frame: (m) => handleFrame(m, picture), picked: handlePicked,
    cells: (m) => {
      state.boxes = m.boxes;
      drawCells(screen.lines, state.boxes, state.camera, screen.aspect);
    },
    problem: (m) => {
      state.error = m.about;
      show('problem', m.text);
    },
    busy: (m) => show('busy', m.text && m.text + ' …'),
  }[message.type];
  handle?.(message);
}

// ---- What input and buttons do

function pick(x, y, then) {
  if (!state.scene || x < 0 || y < 0 || x > 1 || y > 1) return;
  const number = ++state.pick;
  state.picks.set(number, then);
  link.send({type: 'pick', number, x, y, sight: viewRequest()});
}

function marked(x, y, message) {
  const box = byId('picture').getBoundingClientRect(), mark = byId('mark');
  const viewport = byId('viewport').getBoundingClientRect();
  mark.style.left = `${box.left - viewport.left + x * box.width}px`;
  mark.style.top = `${box.top - viewport.top + y * box.height}px`;
  mark.hidden = !message.hit;
  showPicked(byId('picked'), message);
}

function askCells() {
  const depth = Number(byId('cells').value);
  controls.showValues();
  link.send({type: 'cells', scene: state.scene.scene, depth});
}

const isNarrow = () => matchMedia('(max-width: 560px)').matches;

// Settings stand beside the picture, which stays in use; help lies over all of it.
function toggle(id) {
  const dialog = byId(id);
  if (dialog.open) dialog.close();
  else id === 'help' ? dialog.showModal() : dialog.show();
}

// Closes what lies on top, and returns whether there was something.
function escape() {
  const dialog = ['help', 'panel'].map(byId).find((d) => d.open);
  if (dialog) return dialog.close(), true;
  if (byId('picked').hidden && byId('mark').hidden) return false;
  return byId('picked').hidden = byId('mark').hidden = true;
}

async function copy() {
  if (!state.command) return;
  if (!byId('panel').open) toggle('panel');
  byId('said').textContent = state.command;
  try {
    await navigator.clipboard.writeText(state.command);
  } catch {
    getSelection().selectAllChildren(byId('said'));  // no clipboard here: it is there to be copied by the user
  }
}

function save() {
  const url = URL.createObjectURL(state.png), a = document.createElement('a');
  a.href = url;
  a.download = state.scene.names[state.scene.scene].replace(/\.(gz|xz)$/, '').replace(/\.[^.]*$/, '') + '.png';
  a.click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}

const view = {
  get camera() { return state.camera; },
  get box() { return state.scene?.box; },
  get aspect() { return screen.aspect; },
  get height() { return screen.height; },
  place: (e) => screen.place(e),
  change: (camera, at) => state.scene && change(camera, at),
  reset: () => state.scene && change(state.scene.camera),
  click: (x, y) => pick(x, y, (message) => marked(x, y, message)),
  recentre: (x, y) => pick(x, y, (message) => message.hit && change(
    {...state.camera, from: state.camera.from.map((v, k) => v + message.point[k] - state.camera.at[k]), at: message.point})),
  help: () => toggle('help'),
  panel: () => toggle('panel'),
  copy,
  escape,
};

const controls = new Controls(byId, () => settle());
const token = address.token();
const link = new Link(token, receive, (text) => {
  if (text || !state.error) show('problem', text);
});
const input = new InputController(byId('picture'), view);

byId('scene').onchange = () => askScene(Number(byId('scene').value));
byId('cells').oninput = askCells;
byId('smooth').onchange = () => state.scene && link.send({type: 'smooth', scene: state.scene.scene, degrees: Number(byId('smooth').value)});
byId('copy').onclick = copy;
byId('save').onclick = save;
byId('open-panel').onclick = view.panel;
byId('open-help').onclick = view.help;
byId('up').onchange = () => state.camera && change(withUp(state.camera, byId('up').value.split(',').map(Number)));
for (const id of ['panel', 'help']) byId(id).querySelector('.close').onclick = () => byId(id).close();
// A click on the dimmed page around a modal dialog is one on the dialog itself, beside what is in it.
byId('help').onclick = (e) => {
  const box = byId('help').getBoundingClientRect();
  if (e.clientX < box.left || e.clientX > box.right || e.clientY < box.top || e.clientY > box.bottom) byId('help').close();
};
byId('viewport').addEventListener('pointerdown', (e) => {
  if (!isNarrow() || !byId('panel').open) return;
  byId('panel').close();
  e.stopPropagation();
}, {capture: true});
byId('picked').querySelector('.close').onclick = escape;
addEventListener('resize', () => {
  screen.layout();
  clearTimeout(state.resizing);
  state.resizing = setTimeout(() => {
    state.resizing = 0;
    settle();
  }, REST);
});

// The settings end above the strip, however high it is.
new ResizeObserver(() => document.documentElement.style.setProperty('--strip', `${byId('strip').offsetHeight}px`)).observe(byId('strip'));
address.exchange(token);
requestAnimationFrame(tick);
window.kdray = {state, screen, view};  // for whoever scripts the page, and the tests
