// What    What the page's address says behind #: the token, until a cookie stands for it, and the camera, so that a view
//         can be kept and sent.

const fields = () => new URLSearchParams(location.hash.slice(1));

const numbers = (text, n) => {
  const values = text.split(',').map(Number);
  return values.length === n && values.every(Number.isFinite) ? values : null;
};

export function token() {
  return fields().get('token') ?? '';
}

export function camera() {
  const text = fields().get('camera');
  const values = text && numbers(text, 11);
  if (!values) return null;
  const [from, at, up] = [values.slice(0, 3), values.slice(3, 6), values.slice(6, 9)];
  const [fov, ortho] = values.slice(9);
  return fov > 0 && fov < 180 && ortho >= 0 ? {from, at, up, fov, ortho} : null;
}

export function scene() {
  const number = Number(fields().get('scene') ?? 0);
  return Number.isInteger(number) && number >= 0 ? number : 0;
}

function write(change) {
  const all = fields();
  change(all);
  // Commas may stand there as they are.
  history.replaceState(null, '', '#' + all.toString().replaceAll('%2C', ','));
}

// No camera: the scene's own.
export function keep(camera, scene) {
  write((all) => {
    if (camera) all.set('camera', [...camera.from, ...camera.at, ...camera.up, camera.fov, camera.ortho].join(','));
    else all.delete('camera');
    scene > 0 ? all.set('scene', scene) : all.delete('scene');
  });
}

// The token becomes a cookie, and goes out of the address, where somebody might see it. In a frame of another page
// browsers keep no cookie: it stays there.
export async function exchange(text) {
  if (!text) return;
  const answer = await fetch('/session', {method: 'POST', body: text, cache: 'no-store'});
  if (answer.ok && navigator.cookieEnabled && window.top === window) write((all) => all.delete('token'));
}
