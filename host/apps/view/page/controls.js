// What    The panel: what is looked at, and how it is rendered; and the card of what was clicked.

const weightOf = (step) => step === 0 ? -1 : 10 ** (-6 + (step - 1) * 6 / 40);
const small = new Intl.NumberFormat('en', {maximumSignificantDigits: 2, notation: 'standard'});
const linear = (v) => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
const linearColor = (hex) => [1, 3, 5].map((i) => linear(parseInt(hex.slice(i, i + 2), 16) / 255));
const MODES = {
  auto: 'kdray chooses how the queues divide the work.',
  pdprt: 'pdprt: the queues divide the picture; each has the whole scene.',
  odprt: 'odprt: the queues divide the scene; rays travel between them.',
};
const six = (x) => String(Number(x.toPrecision(7)));

export class Controls {
  constructor(byId, changed) {
    this.byId = byId;
    for (const id of ['channel', 'samples', 'mode', 'traversal', 'queues', 'depth', 'weight', 'headlight', 'look', 'backdrop', 'background'])
      byId(id).addEventListener('input', () => {
        this.showValues();
        changed(id);
      });
    byId('smooth').addEventListener('input', () => this.showValues());
    for (const n of [0, 1, 2, 3, 4, 6, 8, 16]) byId('queues').add(new Option(n ? String(n) : 'as given', String(n)));
  }

  // What the scene, or the command line, has.
  begin(scene) {
    this.byId('depth').value = scene.depth;
    this.byId('samples').value = String(scene.samples);
    if (this.byId('samples').selectedIndex < 0) this.byId('samples').value = '0';
    this.look = this.byId('look').value = scene.look;
    this.byId('look-given').hidden = scene.look !== 'as given';
    this.byId('headlight').value = Math.round(scene.headlight * 10);
    this.showValues();
  }

  // How the scene is read; only a file is read again.
  showReading(scene) {
    this.byId('smooth-row').hidden = scene.smooth === undefined;
    this.byId('smooth').value = scene.smooth ?? 0;
    this.showValues();
  }

  showValues() {
    const {weight, headlight, depth} = this.values(), cells = Number(this.byId('cells').value);
    const smooth = Number(this.byId('smooth').value);
    const texts = {depth: String(depth), weight: weight < 0 ? 'as given' : small.format(weight),
                   headlight: headlight > 0 ? String(headlight) : 'off',
                   smooth: smooth ? `edges up to ${smooth}°` : 'as given', cells: cells ? `depth ${cells}` : 'none'};
    for (const [id, text] of Object.entries(texts)) {
      this.byId(`${id}-out`).value = text;
      this.byId(id).setAttribute('aria-valuetext', text);
    }
    this.byId('background-row').hidden = !this.byId('backdrop').value;
    this.byId('mode-means').textContent = MODES[this.byId('mode').value];
  }

  values() {
    const text = (id) => this.byId(id).value;
    return {
      channel: text('channel'), look: text('look') === this.look ? null : text('look'), mode: text('mode'), traversal: text('traversal'),
      queues: Number(text('queues')), depth: Number(text('depth')),
      samples: text('samples') === 'adaptive' ? 'adaptive' : Number(text('samples')),
      weight: weightOf(Number(text('weight'))), headlight: Number(text('headlight')) / 10,
      background: text('backdrop') ? linearColor(text('background')) : null,
    };
  }
}

const srgb = (v) => Math.round(255 * (v <= 0.0031308 ? 12.92 * Math.max(0, v) : 1.055 * Math.min(1, v) ** (1 / 2.4) - 0.055));
const color = (c) => `rgb(${c.map(srgb).join(', ')})`;
const brightest = (c) => Math.max(...c);

export function showPicked(card, picked) {
  card.hidden = false;
  const isInstance = picked.instance !== undefined;
  card.querySelector('h2').textContent =
    picked.hit ? `${picked.kind} ${isInstance ? picked.instance : picked.primitive}` : 'nothing';
  const list = card.querySelector('dl');
  list.replaceChildren();
  const row = (name, ...values) => {
    const dt = document.createElement('dt'), dd = document.createElement('dd');
    dt.textContent = name;
    dd.append(...values);
    list.append(dt, dd);
  };
  if (!picked.hit) return;
  if (isInstance) row('primitive', `${picked.primitive} of its mesh`);
  else row('geometry', picked.name ? `${picked.geometry}, ${picked.name}` : String(picked.geometry));
  if (picked.part) row('part', picked.part);
  row('distance', six(picked.distance));
  row('point', picked.point.map(six).join(', '));
  row('normal', picked.normal.map((x) => x.toFixed(4)).join(', '));
  const m = picked.material;
  if (!m) return;
  const swatch = document.createElement('span');
  swatch.className = 'swatch';
  swatch.style.backgroundColor = color(m.diffuse);
  row('material', swatch, m.name ? `${m.number}, ${m.name}` : String(m.number));
  if (brightest(m.reflect) > 0) row('mirrors', `${small.format(100 * brightest(m.reflect))} %`);
  if (brightest(m.transmit) > 0) row('lets through', `${small.format(100 * brightest(m.transmit))} %, index ${small.format(m.index)}`);
}
