// What    The figures of the last frame: a line, and, where it is opened, all of them.

const digits = new Intl.NumberFormat('en', {maximumSignificantDigits: 3});
const count = (n) => n >= 1e6 ? digits.format(n / 1e6) + ' M' : n >= 1e4 ? digits.format(n / 1e3) + ' k' : String(n);
const ms = (x) => digits.format(x) + ' ms';

function element(name, text, parent) {
  const made = document.createElement(name);
  made.textContent = text;
  parent?.append(made);
  return made;
}

function section(title, rows) {
  if (!rows.length) return [];
  const made = document.createElement('section');
  element('h3', title, made);
  for (const [name, value] of rows) {
    const row = element('div', '', made);
    element('span', name, row);
    element('span', value, row);
  }
  return [made];
}

function line(frame, f, latency) {
  const parts = [`<${ms(f.ms.render)}> a frame`, `${frame.width}×${frame.height}`, `<${digits.format(f.mrays)} Mrays/s>`,
                 `${count(f.rays.total)} rays`, f.mode + (f.queues?.length > 1 ? ` on ${f.queues.length} queues` : '')];
  if (f.samples > 1) parts.push(`${digits.format(f.samples)} samples a pixel`);
  if (latency > 0) parts.push(`${Math.round(latency)} ms from input to frame`);
  return parts;
}

// Of a queue: what it had of the frame, and, of ODPRT, how many rays came and went.
function share(q) {
  return [
    `${count(q.rays)} rays`, q.tiles !== undefined ? `${q.tiles} tiles` : '',
    q.subtrees !== undefined ? `${q.subtrees} subtrees` : '',
    q.out !== undefined ? `${count(q.in)} rays came, ${count(q.out)} left` : '', ms(q.busy)].filter(Boolean).join(', ');
}

// What the colours of channel "queue" stand for.
export function showOwners(card, f) {
  card.replaceChildren();
  for (const q of f.queues ?? []) {
    const row = element('div', '', card), swatch = element('span', '', row);
    swatch.className = 'swatch';
    swatch.style.backgroundColor = `rgb(${q.color.join(', ')})`;
    element('b', `queue ${q.number}`, row);
    element('span', share(q), row);
  }
  const {travelled} = f;
  if (travelled) element('p', `${count(travelled.rays)} rays travelled, ${count(travelled.bytes)} bytes; grey: every queue holds it`, card);
  if (f.queues?.length === 1) element('p', 'one queue traced all of it: take more (Settings, Queues)', card);
}

export class Strip {
  constructor(figures, details, more) {
    Object.assign(this, {figures, details, frame: null, latency: 0});
    more.onclick = () => {
      details.hidden = !details.hidden;
      more.setAttribute('aria-expanded', String(!details.hidden));
      this.draw();
    };
  }

  show(frame, latency) {
    this.frame = frame;
    this.latency = latency;
    this.draw();
  }

  draw() {
    const frame = this.frame, f = frame?.figures;
    if (!f) return;
    this.figures.replaceChildren();
    for (const [i, part] of line(frame, f, this.latency).entries()) {
      if (i) this.figures.append('  ·  ');
      const bold = part.match(/^<(.*)>(.*)$/);
      if (bold) this.figures.append(element('b', bold[1]), bold[2]);
      else this.figures.append(part);
    }
    if (!this.details.hidden) this.details.replaceChildren(...this.sections(frame, f));
  }

  sections(frame, f) {
    const times = Object.entries(f.ms).map(([name, value]) => [name, ms(value)]);
    times.push(['encode', ms(frame.encode)]);
    const {skipped = {}, total, ...kinds} = f.rays;
    const sent = f.travelled ? [['rays', count(f.travelled.rays)], ['bytes', count(f.travelled.bytes)]] : [];
    const queues = (f.queues ?? []).map((q) => [`queue ${q.number}`, share(q)]);
    return [
      ...section('Stages (device time, over all queues)', times),
      ...section('Rays', [...Object.entries(kinds), ['total', total]].map(([name, n]) => [name, count(n)])),
      ...section('Not traced', Object.entries(skipped).filter(([, n]) => n).map(([name, n]) => [name, count(n)])),
      ...section('Work', [['mode', f.mode], ...(f.why ? [['because', f.why]] : []), ['walk', f.traversal], ...queues]),
      ...section('Rays that travelled', sent),
    ];
  }
}
