const ink = { tension: "#d7191c", shear: "#1f4fd8", sliding: "#f5a800", open: "#ffffff", joint: "#1a1a1a", bond: "rgba(0,0,0,.18)",
  outline: "#333333", pinned: "#e0007a", compression: "#123c46", pull: "#c2410c" };
const sequential = ["#fcfbf6", "#dfe5dc", "#b9cac5", "#86a7aa", "#54808b", "#2c5866"];
const diverging = ["#8c510a", "#d8b365", "#f7f6f2", "#8fb5bd", "#2c5866"];
const nColours = 64;
const leastRange = 0.05; // of the largest value, that the colours of a field span

const channels = (hex) => [1, 3, 5].map((at) => parseInt(hex.slice(at, at + 2), 16));
/** Colours in equal steps between the stops. */
function ramp(stops) {
  return Array.from({ length: nColours }, (_, i) => {
    const place = (i / (nColours - 1)) * (stops.length - 1);
    const k = Math.min(Math.floor(place), stops.length - 2);
    const [a, b] = [channels(stops[k]), channels(stops[k + 1])];
    return `rgb(${a.map((c, j) => Math.round(c + (place - k) * (b[j] - c))).join(",")})`;
  });
}
const ramps = { sequential: ramp(sequential), diverging: ramp(diverging) };
const categories = ["#dfe5dc", "#c9b79c", "#a9c1d9", "#d9b8b0", "#b9cfa3", "#c3b5d6", "#e3d28f", "#9fc7c3"];

/** In-plane principal stresses, positive in compression: [larger, smaller, angle of the larger one]. */
function principal(xx, yy, xy) {
  const mean = (xx + yy) / 2;
  const radius = Math.hypot((xx - yy) / 2, xy);
  return [mean + radius, mean - radius, 0.5 * Math.atan2(2 * xy, xx - yy)];
}

/** The fields of blocks: name, unit and value(state, block) in SI. Stresses positive in compression. */
const blockFields = {
  sigma_1: ["σ₁, major principal stress", "Pa", (s, b) => principal(s.xx[b], s.yy[b], s.xy[b])[0]],
  sigma_3: ["σ₃, minor principal stress", "Pa", (s, b) => principal(s.xx[b], s.yy[b], s.xy[b])[1]],
  difference: ["σ₁ − σ₃", "Pa", (s, b) => 2 * Math.hypot((s.xx[b] - s.yy[b]) / 2, s.xy[b])],
  stress_xx: ["stress xx", "Pa", (s, b) => s.xx[b]],
  stress_yy: ["stress yy", "Pa", (s, b) => s.yy[b]],
  stress_xy: ["stress xy", "Pa", (s, b) => s.xy[b]],
  displacement: ["displacement", "m", (s, b) => Math.hypot(...s.mean(b))],
  displacement_x: ["displacement x", "m", (s, b) => s.mean(b)[0]],
  displacement_y: ["displacement y", "m", (s, b) => s.mean(b)[1]],
};
const jointFields = {
  normal_traction: ["normal traction", "Pa"],
  shear_traction: ["shear traction", "Pa"],
  gap: ["opening", "m"],
  slip: ["slip", "m"],
};

/** A number with the unit that leaves it readable. */
const prefixes = { Pa: [[1e9, "GPa"], [1e5, "MPa"], [1e2, "kPa"], [0, "Pa"]], m: [[1, "m"], [1e-6, "mm"], [0, "µm"]] };
const factors = { GPa: 1e9, MPa: 1e6, kPa: 1e3, Pa: 1, m: 1, mm: 1e-3, "µm": 1e-6 };
function unitFor(size, unit) {
  if (!prefixes[unit]) return [1, unit];
  const name = (size > 0 ? prefixes[unit].find(([from]) => size >= from) : prefixes[unit][1])[1];
  return [factors[name], name];
}
const digits = (number, n = 4) => {
  if (number === 0) return "0";
  const size = Math.abs(number);
  return size >= 1e5 || size < 1e-3 ? number.toExponential(n - 1) : String(Number(number.toPrecision(n)));
};
const quantity = (number, unit) => {
  const [factor, name] = unitFor(Math.abs(number), unit);
  return `${digits(number / factor)} ${name}`;
};

/** The share q of the numbers is below it. */
function quantile(numbers, q) {
  if (numbers.length === 0) return 0;
  const sorted = Float64Array.from(numbers).sort();
  return sorted[Math.min(sorted.length - 1, Math.floor(q * sorted.length))];
}

/** The body of a run, drawn on a canvas: `shape` as packed by the program, `names` of materials and the like. */
class BodyView {
  constructor(canvas, shape, run) {
    this.canvas = canvas;
    this.shape = shape;
    this.run = run;
    this.nBlocks = shape.first.length - 1;
    this.nJoints = shape.block_a.length;
    this.options = { field: "sigma_1", joints: "state", magnification: 1, crosses: false, slips: false, forces: false, hold: false };
    this.px = new Float64Array(shape.x.length);
    this.py = new Float64Array(shape.x.length);
    this.pinned = null;
    this.prepareShape();
    this.fit();
  }

  prepareShape() {
    const { x, y, first } = this.shape;
    this.low = [Infinity, Infinity];
    this.high = [-Infinity, -Infinity];
    for (let v = 0; v < x.length; ++v) {
      this.low = [Math.min(this.low[0], x[v]), Math.min(this.low[1], y[v])];
      this.high = [Math.max(this.high[0], x[v]), Math.max(this.high[1], y[v])];
    }
    this.loopsOf = Array.from({ length: this.nBlocks }, () => []);
    for (let l = 0; l + 1 < this.shape.loops.length; ++l)
      this.loopsOf[this.shape.loop_block[l]].push([this.shape.loops[l], this.shape.loops[l + 1]]);
    const area = (this.high[0] - this.low[0]) * (this.high[1] - this.low[1]);
    this.spacing = Math.sqrt(area / Math.max(1, this.nBlocks));
    this.first = first;
  }

  /** Shows the whole body. */
  fit() {
    this.centre = [(this.low[0] + this.high[0]) / 2, (this.low[1] + this.high[1]) / 2];
    this.zoom = 1;
  }

  setState(state) {
    const { first } = this;
    state.mean = (b) => {
      let [x, y] = [0, 0];
      for (let v = first[b]; v < first[b + 1]; ++v) { x += state.ux[v]; y += state.uy[v]; }
      const n = Math.max(1, first[b + 1] - first[b]);
      return [x / n, y / n];
    };
    this.state = state;
    this.values = null;
  }

  get scale() {
    const { width, height } = this.size;
    const margin = 1.06;
    return this.zoom * Math.min(width / (margin * (this.high[0] - this.low[0] || 1)), height / (margin * (this.high[1] - this.low[1] || 1)));
  }
  get size() { return { width: this.canvas.clientWidth, height: this.canvas.clientHeight }; }
  toScreen(x, y) {
    const { width, height } = this.size;
    return [width / 2 + (x - this.centre[0]) * this.scale, height / 2 - (y - this.centre[1]) * this.scale];
  }
  toBody(sx, sy) {
    const { width, height } = this.size;
    return [this.centre[0] + (sx - width / 2) / this.scale, this.centre[1] - (sy - height / 2) / this.scale];
  }
  zoomAt(factor, sx, sy) {
    const before = this.toBody(sx, sy);
    this.zoom = Math.min(2000, Math.max(0.2, this.zoom * factor));
    const after = this.toBody(sx, sy);
    this.centre = [this.centre[0] + before[0] - after[0], this.centre[1] + before[1] - after[1]];
  }
  pan(dx, dy) { this.centre = [this.centre[0] - dx / this.scale, this.centre[1] + dy / this.scale]; }

  /** The values that blocks are coloured by, and their range; null for materials. */
  blockValues() {
    if (this.options.field === "material") return null;
    if (this.values) return this.values;
    const value = blockFields[this.options.field][2];
    const numbers = Float64Array.from({ length: this.nBlocks }, (_, b) => value(this.state, b));
    let [low, high] = [quantile(numbers, 0.01), quantile(numbers, 0.99)];
    if (this.options.hold && this.held?.field === this.options.field) [low, high] = this.held.range;
    const signed = low < 0 && high > 0;
    if (signed) { high = Math.max(high, -low); low = -high; }
    const least = leastRange * Math.max(Math.abs(low), Math.abs(high)); // an even field looks even
    if (high - low < least) [low, high] = [(low + high - least) / 2, (low + high + least) / 2];
    if (!(high > low)) high = low + 1e-6;
    this.held = { field: this.options.field, range: [low, high] };
    this.values = { numbers, low, high, colours: signed ? ramps.diverging : ramps.sequential };
    return this.values;
  }

  draw() {
    if (!this.state) return;
    const ratio = window.devicePixelRatio || 1;
    const { width, height } = this.size;
    if (this.canvas.width !== Math.round(width * ratio) || this.canvas.height !== Math.round(height * ratio)) {
      this.canvas.width = Math.round(width * ratio);
      this.canvas.height = Math.round(height * ratio);
    }
    const context = this.canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    this.place();
    this.drawBlocks(context);
    this.drawJoints(context);
    if (this.options.forces) this.drawForces(context);
    if (this.options.slips) this.drawSlips(context);
    if (this.options.crosses) this.drawCrosses(context);
    this.drawPinned(context);
  }

  /** Where the vertices are on the screen. */
  place() {
    const { x, y } = this.shape;
    const { ux, uy } = this.state;
    const { magnification } = this.options;
    const { scale } = this;
    const [ox, oy] = this.toScreen(0, 0);
    for (let v = 0; v < x.length; ++v) {
      this.px[v] = ox + scale * (x[v] + magnification * ux[v]);
      this.py[v] = oy - scale * (y[v] + magnification * uy[v]);
    }
  }

  trace(context, block) {
    for (const [from, to] of this.loopsOf[block]) {
      context.moveTo(this.px[from], this.py[from]);
      for (let v = from + 1; v < to; ++v) context.lineTo(this.px[v], this.py[v]);
      context.closePath();
    }
  }

  drawBlocks(context) {
    const values = this.blockValues();
    const bins = new Map();
    for (let b = 0; b < this.nBlocks; ++b) {
      let colour = categories[this.shape.material[b] % categories.length];
      if (values) {
        const share = (values.numbers[b] - values.low) / (values.high - values.low);
        colour = values.colours[Math.min(nColours - 1, Math.max(0, Math.round(share * (nColours - 1))))];
      }
      if (!bins.has(colour)) bins.set(colour, []);
      bins.get(colour).push(b);
    }
    context.lineWidth = 0.7; // closes the seams between neighbours
    for (const [colour, blocks] of bins) {
      context.beginPath();
      for (const b of blocks) this.trace(context, b);
      context.fillStyle = context.strokeStyle = colour;
      context.fill();
      context.stroke();
    }
    context.beginPath();
    const { outline } = this.shape;
    for (let i = 0; i + 1 < outline.length; i += 2) {
      context.moveTo(this.px[outline[i]], this.py[outline[i]]);
      context.lineTo(this.px[outline[i + 1]], this.py[outline[i + 1]]);
    }
    context.lineWidth = 1;
    context.strokeStyle = ink.outline;
    context.stroke();
  }

  /** How a joint looks by its state: [colour, width], or null for what is not drawn. */
  lookOf(i, blockPixels) {
    const flags = this.state.flags[i];
    const [motion, bonded, mode] = [flags & 3, flags & 4, flags >> 3];
    if (mode) return [mode === 1 ? ink.tension : ink.shear, 2];
    if (bonded) return this.shape.fracture[i] >= 0 ? [ink.joint, 1.2] : blockPixels > 7 ? [ink.bond, 0.6] : null;
    if (motion === 1) return [ink.sliding, 2.4];
    if (motion === 0) return [ink.open, 2.4];
    return this.shape.fracture[i] >= 0 ? [ink.joint, 1.6] : [ink.joint, blockPixels > 7 ? 0.9 : 0.5];
  }

  drawJoints(context) {
    const { vertex_i, vertex_j, fracture } = this.shape;
    const blockPixels = this.spacing * this.scale;
    const looks = new Map();
    const add = (key, i) => { if (!looks.has(key)) looks.set(key, []); looks.get(key).push(i); };
    const field = this.options.joints === "state" ? null : this.state[this.options.joints];
    if (field) {
      const size = quantile(field.map(Math.abs), 0.98) || 1;
      this.jointRange = size;
      for (let i = 0; i < this.nJoints; ++i) {
        const share = Math.min(1, Math.max(-1, field[i] / size));
        if (Math.abs(share) < 0.02) continue;
        add(`${share > 0 ? ink.shear : ink.tension} ${(0.5 + Math.round(8 * Math.abs(share)) / 2).toFixed(1)}`, i);
      }
    } else {
      for (let i = 0; i < this.nJoints; ++i) {
        const look = this.lookOf(i, blockPixels);
        if (!look) continue;
        const moves = look[0] === ink.sliding || look[0] === ink.open;
        if (moves && fracture[i] >= 0 ) add(`${ink.joint} 3.6`, i);
        add(look.join(" "), i);
      }
    }
    for (const [key, joints] of [...looks].sort((a, b) => this.depth(a[0]) - this.depth(b[0]))) {
      const [colour, width] = key.split(" ");
      context.beginPath();
      for (const i of joints) {
        context.moveTo(this.px[vertex_i[i]], this.py[vertex_i[i]]);
        context.lineTo(this.px[vertex_j[i]], this.py[vertex_j[i]]);
      }
      context.strokeStyle = colour;
      context.lineWidth = Number(width);
      context.stroke();
    }
  }
  /** Cracks and what moves lie above the rest. */
  depth(key) { return [ink.bond, ink.joint, ink.open, ink.sliding, ink.shear, ink.tension].indexOf(key.split(" ")[0]); }

  middleOf(i) {
    const { vertex_i, vertex_j } = this.shape;
    return [(this.px[vertex_i[i]] + this.px[vertex_j[i]]) / 2, (this.py[vertex_i[i]] + this.py[vertex_j[i]]) / 2];
  }
  /** Unit vector along the edge as it is drawn, and the normal to its right, on the screen. */
  directionsOf(i) {
    const { vertex_i, vertex_j } = this.shape;
    const [dx, dy] = [this.px[vertex_j[i]] - this.px[vertex_i[i]], this.py[vertex_j[i]] - this.py[vertex_i[i]]];
    const length = Math.hypot(dx, dy) || 1;
    return { along: [dx / length, dy / length], normal: [-dy / length, dx / length] };
  }
  lengthOf(i) {
    const { x, y, vertex_i, vertex_j } = this.shape;
    return Math.hypot(x[vertex_j[i]] - x[vertex_i[i]], y[vertex_j[i]] - y[vertex_i[i]]);
  }
  isOnScreen([x, y]) { return x > -20 && y > -20 && x < this.size.width + 20 && y < this.size.height + 20; }

  /** Forces of joints as lines in their direction, as wide as they are large. */
  drawForces(context) {
    const { normal_traction, shear_traction } = this.state;
    const sizes = Float64Array.from({ length: this.nJoints }, (_, i) => Math.hypot(normal_traction[i], shear_traction[i]) * this.lengthOf(i));
    const largest = quantile(sizes, 0.99) || 1;
    const half = 0.45 * this.spacing * this.scale;
    context.lineCap = "round";
    for (let i = 0; i < this.nJoints; ++i) {
      const share = Math.min(1, sizes[i] / largest);
      const middle = this.middleOf(i);
      if (share < 0.05 || !this.isOnScreen(middle)) continue;
      const { along, normal } = this.directionsOf(i);
      const [fx, fy] = [0, 1].map((k) => -normal_traction[i] * normal[k] + shear_traction[i] * along[k]);
      const size = Math.hypot(fx, fy) || 1;
      context.beginPath();
      context.moveTo(middle[0] - (half * fx) / size, middle[1] - (half * fy) / size);
      context.lineTo(middle[0] + (half * fx) / size, middle[1] + (half * fy) / size);
      context.lineWidth = Math.max(0.5, 5 * share);
      context.strokeStyle = normal_traction[i] >= 0 ? ink.compression : ink.pull;
      context.stroke();
    }
    context.lineCap = "butt";
    this.largestForce = largest;
  }

  /** Slip of side b against side a, as arrows. */
  drawSlips(context) {
    const { slip, flags } = this.state;
    const moved = [];
    for (let i = 0; i < this.nJoints; ++i) if (!(flags[i] & 4) && slip[i] !== 0) moved.push(i);
    const largest = quantile(moved.map((i) => Math.abs(slip[i])), 0.98) || 1;
    context.strokeStyle = context.fillStyle = ink.shear;
    context.lineWidth = 1.4;
    for (const i of moved) {
      const middle = this.middleOf(i);
      const length = Math.max(-1, Math.min(1, slip[i] / largest)) * 1.2 * this.spacing * this.scale;
      if (Math.abs(length) < 1.5 || !this.isOnScreen(middle)) continue;
      const { along } = this.directionsOf(i);
      const end = [middle[0] + along[0] * length, middle[1] + along[1] * length];
      const head = Math.min(5, Math.abs(length) / 2) * Math.sign(length);
      context.beginPath();
      context.moveTo(...middle);
      context.lineTo(...end);
      context.moveTo(end[0] - head * (along[0] + 0.5 * along[1]), end[1] - head * (along[1] - 0.5 * along[0]));
      context.lineTo(...end);
      context.lineTo(end[0] - head * (along[0] - 0.5 * along[1]), end[1] - head * (along[1] + 0.5 * along[0]));
      context.stroke();
    }
    this.largestSlip = largest;
  }

  centreOf(b) {
    let [x, y] = [0, 0];
    for (let v = this.first[b]; v < this.first[b + 1]; ++v) { x += this.px[v]; y += this.py[v]; }
    const n = Math.max(1, this.first[b + 1] - this.first[b]);
    return [x / n, y / n];
  }

  /** Principal stresses as crosses: dark in compression, orange in tension. */
  drawCrosses(context) {
    const stresses = Array.from({ length: this.nBlocks }, (_, b) => principal(this.state.xx[b], this.state.yy[b], this.state.xy[b]));
    const largest = quantile(stresses.map(([one, three]) => Math.max(Math.abs(one), Math.abs(three))), 0.98) || 1;
    const half = 0.45 * this.spacing * this.scale;
    context.lineWidth = 1.2;
    for (const colour of [ink.compression, ink.pull]) {
      context.beginPath();
      for (let b = 0; b < this.nBlocks; ++b) {
        const [x, y] = this.centreOf(b);
        if (!this.isOnScreen([x, y])) continue;
        const [one, three, angle] = stresses[b];
        for (const [stress, turn] of [[one, angle], [three, angle + Math.PI / 2]]) {
          if ((stress >= 0) !== (colour === ink.compression)) continue;
          const length = half * Math.min(1, Math.abs(stress) / largest);
          const [dx, dy] = [length * Math.cos(turn), -length * Math.sin(turn)];
          context.moveTo(x - dx, y - dy);
          context.lineTo(x + dx, y + dy);
        }
      }
      context.strokeStyle = colour;
      context.stroke();
    }
  }

  drawPinned(context) {
    if (!this.pinned) return;
    context.beginPath();
    if (this.pinned.kind === "block") this.trace(context, this.pinned.index);
    else {
      const { vertex_i, vertex_j } = this.shape;
      context.moveTo(this.px[vertex_i[this.pinned.index]], this.py[vertex_i[this.pinned.index]]);
      context.lineTo(this.px[vertex_j[this.pinned.index]], this.py[vertex_j[this.pinned.index]]);
    }
    context.strokeStyle = ink.pinned;
    context.lineWidth = 3;
    context.stroke();
  }

  /** The joint or the block at a place of the screen: {kind, index}, or null. */
  at(sx, sy) {
    const reach = 5;
    let best = null;
    let nearest = reach;
    const { vertex_i, vertex_j } = this.shape;
    for (let i = 0; i < this.nJoints; ++i) {
      const [ax, ay, bx, by] = [this.px[vertex_i[i]], this.py[vertex_i[i]], this.px[vertex_j[i]], this.py[vertex_j[i]]];
      if (Math.min(ax, bx) > sx + reach || Math.max(ax, bx) < sx - reach || Math.min(ay, by) > sy + reach || Math.max(ay, by) < sy - reach) continue;
      const along = ((sx - ax) * (bx - ax) + (sy - ay) * (by - ay)) / ((bx - ax) ** 2 + (by - ay) ** 2 || 1);
      const t = Math.min(1, Math.max(0, along));
      const distance = Math.hypot(sx - ax - t * (bx - ax), sy - ay - t * (by - ay));
      if (distance < nearest && distance < 0.15 * this.spacing * this.scale + 1) { nearest = distance; best = { kind: "joint", index: i }; }
    }
    if (best) return best;
    for (let b = 0; b < this.nBlocks; ++b) if (this.isInside(b, sx, sy)) return { kind: "block", index: b };
    return null;
  }
  isInside(b, sx, sy) {
    let inside = false;
    for (const [from, to] of this.loopsOf[b])
      for (let v = from, w = to - 1; v < to; w = v++) {
        const crosses = this.py[v] > sy !== this.py[w] > sy;
        if (crosses && sx < ((this.px[w] - this.px[v]) * (sy - this.py[v])) / (this.py[w] - this.py[v]) + this.px[v]) inside = !inside;
      }
    return inside;
  }

  nameOfBlock(b) { return this.run.names.blocks[b] ?? String(b); }

  /** What is known of a block or a joint: [title, [[name, text], ...]]. */
  describe({ kind, index }) {
    return kind === "block" ? this.describeBlock(index) : this.describeJoint(index);
  }
  describeBlock(b) {
    const { xx, yy, xy } = this.state;
    const [one, three, angle] = principal(xx[b], yy[b], xy[b]);
    const degrees = (((angle * 180) / Math.PI) % 180 + 180) % 180;
    const [ux, uy] = this.state.mean(b);
    return [`Block ${this.nameOfBlock(b)}`, [
      ["material", this.run.names.materials[this.shape.material[b]] ?? ""],
      ["σ₁, σ₃", `${quantity(one, "Pa")}, ${quantity(three, "Pa")}`],
      ["direction of σ₁", `${digits(degrees, 3)}° from x`],
      ["σ xx, yy, xy", [xx[b], yy[b], xy[b]].map((each) => quantity(each, "Pa")).join(", ")],
      ["displacement", `${quantity(ux, "m")}, ${quantity(uy, "m")}`],
    ]];
  }
  describeJoint(i) {
    const { flags, normal_traction, shear_traction, gap, slip } = this.state;
    const { names } = this.run;
    const motion = ["open", "sliding", "locked"][flags[i] & 3];
    const failed = ["", ", failed in tension", ", failed in shear"][flags[i] >> 3] ?? "";
    const fracture = names.fractures[this.shape.fracture[i]];
    return [`Joint ${i}${fracture ? ` of ${fracture}` : ""}`, [
      ["interface", names.interfaces[this.shape.type[i]] ?? ""],
      ["blocks", `${this.nameOfBlock(this.shape.block_a[i])}, ${this.nameOfBlock(this.shape.block_b[i])}`],
      ["state", (flags[i] & 4 ? "bonded" : motion) + failed],
      ["normal traction", quantity(normal_traction[i], "Pa")],
      ["shear traction", quantity(shear_traction[i], "Pa")],
      ["opening", quantity(gap[i], "m")],
      ["slip", quantity(slip[i], "m")],
      ["length", quantity(this.lengthOf(i), "m")],
    ]];
  }
}
