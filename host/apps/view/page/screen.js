// What    The picture on the screen, as large as the window, or as kdray was asked for; and the lines over it.

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
