"use strict";
// The worst part of each method: what pushes it, the part in its guide, force and positions.
(() => {
  const scenes = JSON.parse(document.getElementById("courses").textContent);
  const byId = (id) => document.getElementById(id);
  const stage = byId("stage"), seek = byId("seek"), told = byId("told"), play = byId("play");
  const choice = byId("scene"), slowed = byId("slowed"), cases = document.querySelectorAll("select.case");
  const calm = window.matchMedia("(prefers-reduced-motion: reduce)");
  const INK = "#1b1f24", SOFT = "#57606a", LINE = "#d8dee4", FORCE = "#0072B2", WAY = "#D55E00";
  const SLIP = "#F3D9C9", STEEL = "#aab4be", TIP = "#3d4650", DRIVE = "#009E73", PART = "#e8c9a0";
  const SLIP_PLAYS_S = 8, CALM_STEP_S = 0.5;
  const state = { case: scenes[0].case, scene: 0, mode: "slip", time: 0, playing: false, loop: 0, last: 0, drawn: 0 };

  const ofCase = () => scenes.filter((s) => s.case === state.case);
  const current = () => ofCase()[state.scene];
  const columns = () => current()[state.mode];
  const start = () => columns().t[0];
  const end = () => columns().t[columns().t.length - 1];
  const speed = () => (state.mode === "whole" ? 1 : Math.min(1, (end() - start()) / SLIP_PLAYS_S));

  // The rows are chosen, not evenly spaced: forces are held between them, positions lie on a line.
  // Where there is no axis, drive, tool and tip are undefined; without a stack the tool is the tip.
  function at(columns, time) {
    const { t, x, f, b, drive, tip, tool = tip } = columns;
    let low = 0, high = t.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (t[middle] <= time) low = middle; else high = middle;
    }
    const span = t[high] - t[low], share = span > 0 ? Math.min(1, Math.max(0, (time - t[low]) / span)) : 0;
    const between = (v) => v && v[low] + share * (v[high] - v[low]);
    return { x: between(x), f: share < 1 ? f[low] : f[high], b: between(b), drive: between(drive), tip: between(tip), tool: between(tool) };
  }

  function extent(values) {
    let low = Infinity, high = -Infinity;
    for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
    return [low, high];
  }

  function ticks(low, high, count) {
    const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map((m) => m * power).find((s) => s >= raw);
    const found = [];
    for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k++) found.push(k * step);
    return found;
  }

  const brief = (v) => String(+v.toPrecision(4));

  function draw() {
    const ratio = window.devicePixelRatio || 1, box = stage.getBoundingClientRect();
    const width = Math.max(280, box.width), height = Math.max(240, box.height);
    if (stage.width !== Math.round(width * ratio) || stage.height !== Math.round(height * ratio)) {
      stage.width = Math.round(width * ratio);
      stage.height = Math.round(height * ratio);
    }
    const pen = stage.getContext("2d");
    pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    pen.clearRect(0, 0, width, height);
    pen.font = "12px system-ui, sans-serif";
    const now = at(columns(), state.time);
    const left = 62, inner = width - left - 14;
    drawGuide(pen, left, 8, inner, height * 0.2, now);
    drawMagnifier(pen, left, height * 0.2 + 26, inner, height * 0.11, now);
    const top = height * 0.31 + 78, tall = (height - top - 34) / 2 - 20;
    const c = columns();
    drawTrace(pen, { left, top, inner, tall, name: "force (N)", zero: true,
      lines: [["breakaway", c.b, SOFT, [5, 4]], ["on the part", c.f, FORCE, []]] });
    const axis = c.tip ? [["drive", c.drive, DRIVE, [6, 3]], ["tip", c.tip, TIP, []]] : [];
    drawTrace(pen, { left, top: top + tall + 34, inner, tall, name: "position (mm)", times: true, lines: [...axis, ["part", c.x, WAY, []]] });
    tell(now);
    state.drawn += 1;
    stage.dataset.frames = state.drawn;
    stage.dataset.time = state.time;
    stage.dataset.gap = now.tip === undefined ? "" : gapOf(now);
  }

  const gapOf = (now) => 1e3 * (now.x - now.tip); // in micrometers; below zero where the tip presses
  const apart = (now) => now.f === 0 && now.x > now.tip;

  function drawGuide(pen, left, top, inner, tall, now) {
    const s = current(), long = s.length_mm, scale = inner / (2.4 * long);
    const px = (mm) => left + (mm + 0.32 * long) * scale;
    const wall = tall * 0.2, part = tall - 2 * wall - 4, middle = top + tall / 2;
    pen.fillStyle = STEEL;
    pen.fillRect(px(0), top, px(long) - px(0), wall);
    pen.fillRect(px(0), top + tall - wall, px(long) - px(0), wall);
    pen.fillStyle = PART;
    pen.strokeStyle = INK;
    pen.lineWidth = 1;
    const x0 = px(now.x), x1 = px(now.x + long);
    pen.fillRect(x0, top + wall + 2, x1 - x0, part);
    pen.strokeRect(x0, top + wall + 2, x1 - x0, part);
    if (now.tip !== undefined) drawAxis(pen, px(now.tip), middle, part, scale, (px(0) - left) / 11, now, px(0));
    drawForce(pen, x0, middle, inner, now, left, px(2.06 * long));
    pen.fillStyle = INK;
    pen.textAlign = "left";
    pen.fillText(`guide, ${brief(long)} mm`, px(0) + 6, top + wall / 2 + 4);
  }

  // From the right: tip, stack, tool, the axis' spring, its drive. Lengths of `unit` at rest.
  function drawAxis(pen, face, middle, tall, scale, unit, now, outside) {
    const stack = current().slip.tool ? 2.6 * unit + scale * (now.tip - now.tool) : 0;
    const cone = face - 1.2 * unit, tool = cone - stack, back = tool - 2.4 * unit;
    const spring = Math.max(0.4 * unit, 2.4 * unit - scale * (now.drive - now.tool)), drive = back - spring;
    pen.fillStyle = TIP;
    pen.beginPath();
    pen.moveTo(cone, middle - 0.22 * tall); pen.lineTo(face, middle - 0.1 * tall);
    pen.lineTo(face, middle + 0.1 * tall); pen.lineTo(cone, middle + 0.22 * tall);
    pen.fill();
    for (let k = 0; stack && k < 5; k++) {
      pen.fillStyle = k % 2 ? "#f2ead0" : "#c9a227";
      pen.fillRect(tool + (k * stack) / 5, middle - 0.22 * tall, stack / 5, 0.44 * tall);
    }
    pen.fillStyle = STEEL;
    pen.fillRect(back, middle - 0.42 * tall, tool - back, 0.84 * tall);
    pen.strokeStyle = TIP;
    pen.lineWidth = 1.5;
    pen.beginPath(); pen.moveTo(back, middle);
    for (let k = 1; k < 8; k++) pen.lineTo(back - (spring * k) / 8, middle + (k % 2 ? 0.22 : -0.22) * tall);
    pen.lineTo(drive, middle); pen.stroke();
    pen.fillStyle = DRIVE;
    pen.fillRect(drive - 0.8 * unit, middle - 0.5 * tall, 0.8 * unit, tall);
    pen.fillStyle = SOFT;
    pen.textAlign = "center";
    const names = [["drive", drive - 0.4 * unit], ["tool", (back + tool) / 2], ["stack", stack && tool + stack / 2]];
    for (const [name, x] of names) { // while they are not in the guide
      if (x && unit > 10 && x + 0.5 * pen.measureText(name).width < outside) pen.fillText(name, x, middle + 0.5 * tall + 15);
    }
  }

  // Without an axis the arrow pushes the part's edge from outside; else it starts at the tip's face.
  function drawForce(pen, edge, middle, inner, now, left, right) {
    const long = (now.f / current().stiction_n) * 0.1 * inner;
    const [from, to] = now.tip === undefined ? [edge - long, edge] : [edge, edge + long];
    drawArrow(pen, Math.min(right, Math.max(left, from)), Math.min(right, Math.max(left, to)), middle);
  }

  function drawArrow(pen, from, to, y) {
    const way = Math.sign(to - from), head = Math.min(9, Math.abs(to - from));
    if (head < 2) return;
    pen.strokeStyle = pen.fillStyle = FORCE;
    pen.lineWidth = 3;
    pen.beginPath(); pen.moveTo(from, y); pen.lineTo(to - way * head, y); pen.stroke();
    pen.beginPath(); pen.moveTo(to, y); pen.lineTo(to - way * head, y - 5); pen.lineTo(to - way * head, y + 5); pen.fill();
  }

  // About the worst slip, with room on the left for a tip that stays behind.
  function magnified() {
    const { x, tip } = current().slip, [low, high] = extent(x), long = high - low || 1e-3;
    const behind = tip ? Math.min(low, Math.max(extent(tip)[0], low - 0.5 * long)) : low - 0.3 * long;
    return [behind - 0.12 * long, high + 0.12 * long];
  }

  function drawMagnifier(pen, left, top, inner, tall, now) {
    const s = current(), [from, to] = magnified(), right = left + inner;
    const px = (mm) => left + ((mm - from) / (to - from)) * inner;
    const slipFrom = at(s.slip, s.slip_s[0]).x, slipTo = at(s.slip, s.slip_s[1]).x;
    pen.fillStyle = SLIP;
    pen.fillRect(px(slipFrom), top, Math.max(1, px(slipTo) - px(slipFrom)), tall);
    pen.strokeStyle = LINE;
    pen.lineWidth = 1;
    pen.strokeRect(left, top, inner, tall);
    pen.fillStyle = SOFT;
    pen.textAlign = "center";
    for (const mark of ticks(from, to, Math.max(2, Math.floor(inner / 130)))) {
      pen.beginPath(); pen.moveTo(px(mark), top + tall); pen.lineTo(px(mark), top + tall - 6); pen.strokeStyle = SOFT; pen.stroke();
      pen.fillText(`${+mark.toFixed(5)} mm`, px(mark), top + tall + 13);
    }
    const inside = now.x >= from && now.x <= to, middle = top + tall / 2 - 2;
    if (inside) {
      pen.fillStyle = PART;
      pen.fillRect(px(now.x), top + 4, right - px(now.x), tall - 12);
    }
    if (now.tip > from && inside) drawFace(pen, left, px(now.tip), px(now.x), middle, tall, now);
    if (inside) {
      drawForce(pen, px(now.x), middle, inner, now, left, right);
      pen.fillStyle = INK;
      pen.fillRect(px(now.x) - 1, top + 1, 2, tall - 2);
    }
    pen.textAlign = "right";
    pen.fillStyle = SOFT;
    const across = to - from >= 1 ? `${brief(to - from)} mm` : `${brief(1e3 * (to - from))} µm`;
    const where = inside ? "" : now.x < from ? ", the part's edge is not there yet" : ", the part's edge is past it";
    pen.fillText(`magnifier, ${across} across${where}`, right, top - 6);
  }

  // The tip's face up close. What reaches past the part's edge is how far their contact is pressed.
  function drawFace(pen, left, face, edge, middle, tall, now) {
    pen.globalAlpha = 0.75;
    pen.fillStyle = TIP;
    pen.fillRect(left, middle - 0.22 * tall, face - left, 0.44 * tall);
    pen.globalAlpha = 1;
    const words = apart(now) ? `no contact, gap ${gapOf(now).toFixed(1)} µm` : "tip";
    pen.textAlign = "right";
    if (face - left > pen.measureText(words).width + 12) {
      pen.fillStyle = "#fff";
      pen.fillText(words, Math.min(face, edge) - 6, middle + 4);
    }
  }

  function drawTrace(pen, panel) {
    const { left, top, inner, tall, lines } = panel, c = columns();
    const px = (t) => left + ((t - start()) / (end() - start() || 1)) * inner;
    const ends = lines.map(([, values]) => extent(values)), [least, most] = ends[ends.length - 1];
    let low = Math.min(...ends.map((e) => e[0])), high = Math.max(...ends.map((e) => e[1]));
    high = Math.min(high, most + 2 * (most - least) || high); // a soft axis' drive may be far ahead
    if (panel.zero) low = Math.min(0, low);
    const room = 0.06 * (high - low) || 1e-6;
    high += room; low -= panel.zero ? 0 : room;
    const py = (v) => top + tall - ((v - low) / (high - low)) * tall;
    const [slipFrom, slipTo] = current().slip_s;
    pen.fillStyle = SLIP;
    pen.fillRect(px(slipFrom), top, Math.max(1, px(slipTo) - px(slipFrom)), tall);
    pen.textAlign = "right";
    for (const mark of ticks(low, high, 4)) {
      pen.strokeStyle = LINE; pen.lineWidth = 1;
      pen.beginPath(); pen.moveTo(left, py(mark)); pen.lineTo(left + inner, py(mark)); pen.stroke();
      pen.fillStyle = SOFT;
      pen.fillText(+mark.toPrecision(6), left - 6, py(mark) + 4);
    }
    pen.save();
    pen.beginPath(); pen.rect(left, top - 2, inner, tall + 4); pen.clip();
    for (const [, values, color, dash] of lines) {
      pen.strokeStyle = color; pen.lineWidth = dash.length ? 1 : 1.4; pen.setLineDash(dash);
      pen.beginPath();
      values.forEach((v, i) => (i ? pen.lineTo(px(c.t[i]), py(v)) : pen.moveTo(px(c.t[i]), py(v))));
      pen.stroke();
    }
    pen.restore();
    pen.setLineDash([]);
    pen.strokeStyle = INK; pen.lineWidth = 1;
    pen.beginPath(); pen.moveTo(px(state.time), top); pen.lineTo(px(state.time), top + tall); pen.stroke();
    drawKey(pen, left, top, panel);
    if (!panel.times) return;
    const slip = state.mode === "slip", zero = slip ? slipFrom : 0, unit = slip ? 1e3 : 1;
    pen.textAlign = "center"; pen.fillStyle = SOFT;
    for (const mark of ticks((start() - zero) * unit, (end() - zero) * unit, Math.max(2, Math.floor(inner / 110)))) {
      pen.fillText(+mark.toPrecision(6), px(zero + mark / unit), top + tall + 15);
    }
    pen.fillText(slip ? "time since it slips (ms)" : "time (s)", left + inner / 2, top + tall + 30);
  }

  // The panel's name, then a sample of each line with what it is.
  function drawKey(pen, left, top, { name, lines }) {
    const words = [[name, null, []], ...lines.map(([word, , color, dash]) => [word, color, dash]).reverse()];
    const wide = words.map(([word, color]) => pen.measureText(word).width + (color ? 46 : 8));
    pen.textAlign = "left";
    let x = left;
    words.forEach(([word, color, dash], i) => {
      pen.fillStyle = INK;
      pen.fillText(word, x + (color ? 30 : 0), top - 6);
      if (color) {
        pen.strokeStyle = color; pen.lineWidth = 2; pen.setLineDash(dash);
        pen.beginPath(); pen.moveTo(x + 6, top - 10); pen.lineTo(x + 26, top - 10); pen.stroke();
        pen.setLineDash([]);
      }
      x += wide[i];
    });
  }

  // What pushes, in words.
  function pushing(now) {
    if (now.tip === undefined) return now.f === 0 ? "; nothing pushes" : "";
    const drive = `drive ${Math.round(1e3 * (now.drive - now.tool))} µm ahead of the tool`, longer = 1e3 * (now.tip - now.tool);
    const stack = current().slip.tool ? `, stack ${Math.abs(longer).toFixed(1)} µm ${longer < 0 ? "shorter" : "longer"}` : "";
    return `; ${apart(now) ? `tip ${gapOf(now).toFixed(1)} µm apart` : now.f > 0 ? "tip pushes" : now.f < 0 ? "tip pulls" : "tip touches"}, ${drive}${stack}`;
  }

  function tell(now) {
    const s = current(), slip = state.mode === "slip";
    const time = slip ? `${((state.time - s.slip_s[0]) * 1e3).toFixed(2)} ms since it slips` : `${state.time.toFixed(2)} s`;
    told.textContent = `Part no. ${s.part}, ${brief(s.mass_kg)} kg, breaks loose at ${brief(s.stiction_n)} N; jumps ` +
      `${brief(s.jump_mm)} mm at most${s.released ? "" : "; left in place"}. ${time}: force ${now.f.toFixed(0)} N, position ${now.x.toFixed(slip ? 4 : 2)} mm${pushing(now)}.`;
  }

  function show(time) {
    state.time = Math.min(end(), Math.max(start(), time));
    seek.value = Math.round((1000 * (state.time - start())) / (end() - start() || 1));
    seek.setAttribute("aria-valuetext", `${state.time.toFixed(4)} seconds`);
    draw();
  }

  function setPlaying(yes) {
    state.playing = yes;
    play.textContent = yes ? "Pause" : "Play";
    play.setAttribute("aria-pressed", String(yes));
    if (!yes) return;
    if (state.time >= end()) state.time = start();
    state.last = performance.now();
    state.loop += 1;
    next(state.loop);
  }

  // Smoothly, or in rare steps for those who asked their system for less motion.
  function next(loop) {
    if (calm.matches) setTimeout(step, 1000 * CALM_STEP_S, loop); else requestAnimationFrame(() => step(loop));
  }

  function step(loop) {
    if (!state.playing || loop !== state.loop) return;
    const now = performance.now(), passed = (now - state.last) / 1000;
    state.last = now;
    show(state.time + passed * speed());
    if (state.time >= end()) setPlaying(false); else next(loop);
  }

  function reset() {
    const factor = current().slip.t, long = factor[factor.length - 1] - factor[0];
    const times = Math.max(1, SLIP_PLAYS_S / (long || 1));
    slowed.textContent = times > 1 ? `slowed ${brief(+times.toPrecision(2))} times` : "in real time";
    show(start());
  }

  function setCase(key) {
    state.case = key;
    cases.forEach((select) => { select.value = key; });
    document.querySelectorAll("figure[data-case]").forEach((figure) => { figure.hidden = figure.dataset.case !== key; });
    reset();
  }

  ofCase().forEach((s, i) => choice.add(new Option(s.method, i)));
  cases.forEach((select) => select.addEventListener("change", () => setCase(select.value)));
  choice.addEventListener("change", () => { state.scene = Number(choice.value); reset(); });
  document.querySelectorAll('input[name="mode"]').forEach((radio) =>
    radio.addEventListener("change", () => { state.mode = radio.value; reset(); }));
  play.addEventListener("click", () => setPlaying(!state.playing));
  seek.addEventListener("input", () => show(start() + (Number(seek.value) / 1000) * (end() - start())));
  stage.addEventListener("keydown", (event) => {
    const moves = { ArrowLeft: -0.01, ArrowRight: 0.01, Home: -2, End: 2 };
    if (event.key === " ") setPlaying(!state.playing);
    else if (event.key in moves) show(state.time + moves[event.key] * (end() - start()));
    else return;
    event.preventDefault();
  });
  const settle = () => { byId("calm").hidden = !calm.matches; };
  calm.addEventListener("change", settle);
  window.addEventListener("resize", draw);
  settle();
  setCase(state.case);
})();
