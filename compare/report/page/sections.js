// Fields over a section: particles as dots, cells as rectangles, coloured by one quantity; a panel a run.
const viridis = ['#440154', '#482878', '#3e4989', '#31688e', '#26828e', '#1f9e89', '#35b779', '#6ece58', '#b5de2b', '#fde725'];
const colourTable = (() => {
  const channel = (hex, at) => parseInt(hex.slice(at, at + 2), 16);
  return Array.from({length: 256}, (_, i) => {
    const at = i / 255 * (viridis.length - 1), k = Math.min(viridis.length - 2, Math.floor(at)), w = at - k;
    return 'rgb(' + [1, 3, 5].map(c => Math.round(channel(viridis[k], c) * (1 - w) + channel(viridis[k + 1], c) * w)).join(' ') + ')';
  });
})();
const bytesOf = text => Uint8Array.from(atob(text || ''), c => c.charCodeAt(0));
const wordsOf = text => { const bytes = bytesOf(text); return new Uint16Array(bytes.buffer, 0, bytes.length >> 1); };

const drawSection = (block, body) => {
  const {x, z} = block;
  const wide = x.to - x.from, high = z.to - z.from;
  let quantity = 0;
  const panels = block.panels.map(panel => {
    const entry = entries[panel.entry];
    const canvas = element('canvas', {role: 'img', 'aria-label': `${entry.name}: ${block.title}`});
    const head = element('p', {class: 'panel-name'}, entry.name, ...badgesOf(entry));
    const note = element('p', {class: 'small panel-note'});
    const node = element('div', {class: 'panel'}, head, ...(panel.missing ? [element('p', {class: 'missing'}, panel.missing)] : [canvas, note]));
    const cells = panel.west ? ['west', 'east', 'bottom', 'top'].map(key => wordsOf(panel[key])) : null;
    const frames = panel.frames.map(frame => ({...frame, decoded: null}));
    return {panel, entry, canvas, node, note, cells, frames};
  });
  const grid = element('div', {class: 'panels'}, ...panels.map(panel => panel.node));
  const decode = frame => frame.decoded || (frame.decoded = {x: wordsOf(frame.x), z: wordsOf(frame.z), cover: bytesOf(frame.cover), values: frame.values.map(bytesOf)});
  // A level section is too low for its axis to be named inside it.
  const margin = {left: 44, right: 10, top: block.to_scale ? 24 : 8, bottom: 34};
  // Heights are stretched by a whole number once the material lies flat; every panel by the same.
  const topOf = (panel, frame) => {
    const {x: px, z: pz, cover} = decode(frame);
    let top = 0;
    if (panel.cells) cover.forEach((c, i) => { if (c > 127 && panel.cells[3][i] > top) top = panel.cells[3][i]; });
    else for (let i = 0; i < px.length; ++i) if (pz[i] > top) top = pz[i];
    return z.from + top / 65535 * high;
  };
  const paintPanel = (panel, time, stretch) => {
    const {canvas, frames, cells} = panel;
    if (panel.panel.missing || !frames.length) return;
    const times = frames.map(frame => frame.time);
    const frame = frames[nearestFrame(times, time)];
    const {x: px, z: pz, cover, values} = decode(frame);
    const ratio = printing ? 3 : window.devicePixelRatio || 1;
    const width = canvas.parentElement.clientWidth || 320;
    const scale = (width - margin.left - margin.right) / wide;
    const height = Math.round(scale * high + margin.top + margin.bottom);
    canvas.width = width * ratio; canvas.height = height * ratio;
    canvas.style.height = height + 'px';
    const ctx = canvas.getContext('2d');
    ctx.setTransform(ratio, 0, 0, ratio, 0, 0);
    ctx.fillStyle = printing ? '#ffffff' : palette.panel;
    ctx.fillRect(0, 0, width, height);
    const left = v => margin.left + scale * (x.from + v / 65535 * wide - x.from);
    const foot = height - margin.bottom;
    const up = v => foot - scale * stretch * (v / 65535 * high);
    const value = values[quantity];
    ctx.save();
    ctx.beginPath();
    ctx.rect(margin.left, margin.top, scale * wide, foot - margin.top);
    ctx.clip();
    if (value && value.length) {
      if (cells) {
        const [west, east, bottom, top] = cells;
        for (let i = 0; i < cover.length; ++i) {
          if (cover[i] < 3) continue;
          ctx.globalAlpha = cover[i] / 255;
          ctx.fillStyle = colourTable[value[i]];
          ctx.fillRect(left(west[i]), up(top[i]), left(east[i]) - left(west[i]) + 0.4, up(bottom[i]) - up(top[i]) + 0.4);
        }
      } else {
        const size = Math.max(1.2, panel.panel.size * scale);
        for (let i = 0; i < px.length; ++i) {
          ctx.fillStyle = colourTable[value[i]];
          ctx.fillRect(left(px[i]) - size / 2, up(pz[i]) - size * stretch / 2, size, Math.max(size, size * stretch * 0.98));
        }
      }
    } else {
      ctx.fillStyle = palette.soft;
      ctx.font = '13px ' + Chart.defaults.font.family;
      ctx.fillText('not recorded by this run', margin.left + 12, margin.top + 24);
    }
    ctx.restore();
    axes(ctx, scale, stretch, foot, width);
    const off = Math.abs(frame.time - time) > 0.02 * Math.max(time, 1e-9) + 1e-6;
    panel.note.textContent = (off ? `State at ${timeText(frame.time)}. ` : '') + (stretch > 1 ? `Heights \u00d7 ${stretch}` : block.to_scale ? 'To scale' : 'Heights to scale');
  };
  const axes = (ctx, scale, stretch, foot, width) => {
    ctx.strokeStyle = palette.soft;
    ctx.fillStyle = palette.soft;
    ctx.lineWidth = 1;
    ctx.font = '12px ' + Chart.defaults.font.family;
    ctx.beginPath();
    ctx.moveTo(margin.left, margin.top); ctx.lineTo(margin.left, foot); ctx.lineTo(width - margin.right, foot);
    const step = (span, count) => { const raw = span / count, power = Math.pow(10, Math.floor(Math.log10(raw))); return [1, 2, 5, 10].map(m => m * power).find(m => m >= raw); };
    const across = step(wide, Math.max(2, Math.floor(width / 90)));
    ctx.textAlign = 'center'; ctx.textBaseline = 'top';
    for (let v = Math.ceil(x.from / across) * across; v <= x.to * (1 + 1e-9); v += across) {
      const at = margin.left + scale * (v - x.from);
      ctx.moveTo(at, foot); ctx.lineTo(at, foot + 4);
      ctx.fillText(String(Number(v.toPrecision(6))), at, foot + 6);
    }
    const upwards = step(high / stretch, 4);
    ctx.textAlign = 'right'; ctx.textBaseline = 'middle';
    for (let v = Math.ceil(z.from / upwards) * upwards; v <= z.from + high / stretch * (1 + 1e-9); v += upwards) {
      const at = foot - scale * stretch * (v - z.from);
      ctx.moveTo(margin.left - 4, at); ctx.lineTo(margin.left, at);
      ctx.fillText(String(Number(v.toPrecision(6))), margin.left - 6, at);
    }
    ctx.stroke();
    ctx.textAlign = 'right'; ctx.textBaseline = 'bottom';
    ctx.fillText(axisName(x), width - margin.right, foot + 33);
    ctx.textAlign = 'left'; ctx.textBaseline = 'top';
    ctx.fillText(axisName(z), margin.left + (block.to_scale ? -30 : 6), block.to_scale ? 4 : margin.top);
  };
  let shownTime = 0;
  const paint = () => {
    const visible = panels.filter(panel => panel.entry.shown && !panel.panel.missing && panel.frames.length);
    const top = visible.reduce((most, panel) => Math.max(most, topOf(panel, panel.frames[nearestFrame(panel.frames.map(f => f.time), shownTime)])), 0) - z.from;
    const stretch = top > 0 && !block.to_scale ? Math.max(1, Math.min(8, Math.floor(high / (1.2 * top)))) : 1;
    for (const panel of panels) panel.node.hidden = !panel.entry.shown;
    for (const panel of visible) paintPanel(panel, shownTime, stretch);
  };
  // The colours' key, and the choice between the quantities.
  const key = element('div', {class: 'colours'});
  const bar = element('span', {class: 'bar', 'aria-hidden': 'true'});
  bar.style.background = `linear-gradient(to right, ${viridis.join(', ')})`;
  const low = element('span'), highest = element('span'), keyName = element('span', {class: 'key-name'});
  const label = () => {
    const q = block.quantities[quantity];
    keyName.textContent = q.name + (q.unit ? ` (${q.unit}${q.log ? ', logarithmic' : ''})` : '');
    low.textContent = (q.log ? '\u2264\u2009' : '') + significant(q.from, q.log ? 1 : 2);
    highest.textContent = '\u2265\u2009' + significant(q.to, q.log ? 1 : 2);
  };
  const select = element('select', {'aria-label': 'Colour by'});
  block.quantities.forEach((q, i) => select.append(element('option', {value: i}, q.name)));
  const wanted = block.quantities.findIndex(q => q.name === state.get(block.id + '.colour'));
  if (wanted > 0) quantity = wanted;
  select.value = quantity;
  select.addEventListener('change', () => { quantity = Number(select.value); remember(block.id + '.colour', quantity ? block.quantities[quantity].name : null); label(); paint(); });
  key.append(...(block.quantities.length > 1 ? [element('label', {}, 'Colour by ', select)] : []), keyName, low, bar, highest);
  label();
  const when = body.parentElement.querySelector('.when');
  const slider = timeSlider(block, frame => {
    shownTime = block.times[frame];
    if (when) when.textContent = ' at ' + timeText(shownTime);
    paint();
  });
  body.append(grid, slider.node, key);
  painters.push(paint);
  visibility.push(paint);
  new ResizeObserver(() => paint()).observe(grid);
  slider.start();
  const unpack = (q, v) => q.log ? q.from * Math.pow(q.to / q.from, v / 255) : q.from + (q.to - q.from) * v / 255;
  return {canvases: () => panels.filter(panel => panel.entry.shown && !panel.panel.missing).map(panel => panel.canvas), rows: () => {
    const place = (axis, v) => Number((axis.from + (axis.to - axis.from) * v / 65535).toPrecision(5));
    const rows = [['run', 'time (s)', axisName(x), axisName(z), 'fraction', ...block.quantities.map(axisName)]];
    for (const {entry, frames, cells} of panels)
      for (const frame of frames) {
        const {x: px, z: pz, cover, values} = decode(frame);
        const count = cells ? cover.length : px.length;
        for (let i = 0; i < count; ++i) {
          if (cells && cover[i] < 3) continue;
          const at = cells ? [(cells[0][i] + cells[1][i]) / 2, (cells[2][i] + cells[3][i]) / 2] : [px[i], pz[i]];
          rows.push([entry.name, frame.time, place(x, at[0]), place(z, at[1]), cells ? Number((cover[i] / 255).toFixed(3)) : 1,
            ...block.quantities.map((q, k) => values[k] && values[k].length ? Number(unpack(q, values[k][i]).toPrecision(3)) : '')]);
        }
      }
    return rows;
  }};
};
