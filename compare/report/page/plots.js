// Plots, bars and curves that change with time, by Chart.js.
const charts = [];
Chart.defaults.font.family = getComputedStyle(document.documentElement).fontFamily;
Chart.defaults.font.size = 13;
Chart.defaults.animation = false;
let printing = false;

// Of every curve shown the point nearest to the pointer's x, where the curve has one there.
Chart.Interaction.modes.abreast = (chart, event) => {
  const across = chart.config.options.upright ? 'y' : 'x';
  const position = Chart.helpers.getRelativePosition(event, chart);
  const reach = 0.02 * (across === 'x' ? chart.chartArea.width : chart.chartArea.height) + 4;
  return chart.getSortedVisibleDatasetMetas().flatMap(meta => {
    let best = null;
    meta.data.forEach((point, index) => {
      const away = Math.abs(point[across] - position[across]);
      if (!point.skip && Number.isFinite(away) && away <= reach && (!best || away < best.away)) best = {element: point, datasetIndex: meta.index, index, away};
    });
    return best ? [best] : [];
  }).sort((a, b) => a.datasetIndex - b.datasetIndex);
};

// Exported or copied as an image, a chart keeps its ground; where it is read, a rule stands.
const ground = {id: 'ground', beforeDraw: chart => {
  const {ctx} = chart;
  ctx.save();
  ctx.fillStyle = printing ? '#ffffff' : palette.panel;
  ctx.fillRect(0, 0, chart.width, chart.height);
  ctx.restore();
}, afterDatasetsDraw: chart => {
  const active = chart.tooltip && chart.tooltip.getActiveElements();
  if (!active || !active.length || chart.config.type !== 'line' || chart.config.options.nearest) return;
  const {ctx, chartArea} = chart, at = active[0].element;
  ctx.save();
  ctx.strokeStyle = palette.soft;
  ctx.lineWidth = 1;
  ctx.setLineDash([2, 3]);
  ctx.beginPath();
  if (chart.config.options.upright) { ctx.moveTo(chartArea.left, at.y); ctx.lineTo(chartArea.right, at.y); }
  else { ctx.moveTo(at.x, chartArea.top); ctx.lineTo(at.x, chartArea.bottom); }
  ctx.stroke();
  ctx.restore();
}};
// The interval of a value, as a bar.
const intervals = {id: 'intervals', beforeDatasetsDraw: chart => {
  const {ctx, scales} = chart;
  chart.data.datasets.forEach((dataset, d) => {
    if (!dataset.interval || !chart.isDatasetVisible(d)) return;
    ctx.save();
    ctx.strokeStyle = dataset.borderColor;
    ctx.lineWidth = 1.6;
    dataset.data.forEach((point, i) => {
      const [low, high] = dataset.interval(i);
      if (!isNumber(low) || !isNumber(high)) return;
      const x = scales.x.getPixelForValue(point.x), top = scales.y.getPixelForValue(high), foot = scales.y.getPixelForValue(low);
      ctx.beginPath();
      ctx.moveTo(x, top); ctx.lineTo(x, foot);
      ctx.moveTo(x - 4, top); ctx.lineTo(x + 4, top);
      ctx.moveTo(x - 4, foot); ctx.lineTo(x + 4, foot);
      ctx.stroke();
    });
    ctx.restore();
  });
}};

const decades = v => /^1(?:\.0*)?e/.test(v.toExponential()) ? String(Number(v.toPrecision(1))) : '';
const oneTwoFive = v => [1, 2, 5].includes(Number(v.toExponential(0)[0])) && Math.abs(v / Number(v.toPrecision(1)) - 1) < 1e-9 ? String(Number(v.toPrecision(1))) : '';
const scaleOf = (axis, logarithmic, values) => {
  const positive = values.filter(v => v > 0);
  const scale = {type: logarithmic ? 'logarithmic' : 'linear', title: {display: true, text: axisName(axis)}, ticks: {maxRotation: 0}, display: true};
  if (axis.from !== null && !(logarithmic && axis.from <= 0)) scale.min = axis.from;
  if (axis.to !== null) scale.max = axis.to;
  if (logarithmic && positive.length) {
    const low = scale.min ?? positive.reduce((a, b) => Math.min(a, b)), high = scale.max ?? positive.reduce((a, b) => Math.max(a, b));
    scale.ticks = {autoSkip: false, maxRotation: 0, callback: high / low > 300 ? decades : oneTwoFive};
  }
  return painted(scale);
};
// Colours are asked for at every drawing, so that a change of theme needs no more than that.
const painted = scale => ({...scale, grid: {...scale.grid, color: () => palette.grid, borderColor: () => palette.soft},
  ticks: {...scale.ticks, color: () => palette.soft}, title: {...scale.title, color: () => palette.ink}});
const paintTooltip = chart => {
  const {tooltip} = chart.options.plugins;
  tooltip.backgroundColor = palette.ink;
  tooltip.titleColor = palette.paper;
  tooltip.bodyColor = palette.paper;
};
const setup = (canvas, block, config, paint) => {
  canvas.setAttribute('role', 'img');
  canvas.setAttribute('tabindex', '0');
  canvas.setAttribute('aria-label', figureTitle(block) + '. Arrow keys read values.');
  config.plugins = [ground, intervals];
  config.options = {responsive: true, maintainAspectRatio: false, animation: false, ...config.options};
  config.options.plugins = {legend: {display: false}, title: {display: false}, ...config.options.plugins,
    tooltip: {usePointStyle: true, boxPadding: 4, position: config.options.nearest || config.type === 'bar' ? 'nearest' : 'average', padding: 9, cornerRadius: 6, ...config.options.plugins?.tooltip}};
  const chart = new Chart(canvas, config);
  const repaintChart = () => { paint(chart); paintTooltip(chart); chart.update('none'); };
  painters.push(repaintChart);
  visibility.push(() => {
    chart.data.datasets.forEach((dataset, i) => { if (dataset.entry) chart.setDatasetVisibility(i, dataset.entry.shown); });
    chart.update('none');
  });
  readByKeyboard(canvas, chart);
  repaintChart();
  charts.push(chart);
  return chart;
};
// Arrow keys walk along the first curve shown; the tooltip follows.
const readByKeyboard = (canvas, chart) => {
  let at = -1;
  const say = element('p', {class: 'spoken', 'aria-live': 'polite'});
  canvas.after(say);
  const clear = () => { chart.setActiveElements([]); chart.tooltip.setActiveElements([], {x: 0, y: 0}); chart.update('none'); };
  canvas.addEventListener('keydown', event => {
    const step = {ArrowLeft: -1, ArrowRight: 1, PageUp: -20, PageDown: 20}[event.key];
    if (event.key === 'Escape') { clear(); return; }
    if (!step && event.key !== 'Home' && event.key !== 'End') return;
    event.preventDefault();
    const meta = chart.getSortedVisibleDatasetMetas()[0];
    if (!meta || !meta.data.length) return;
    const last = meta.data.length - 1;
    at = event.key === 'Home' ? 0 : event.key === 'End' ? last : Math.min(last, Math.max(0, at + step));
    const point = meta.data[at];
    const found = chart.config.type === 'bar' ? chart.data.datasets.map((_, d) => ({datasetIndex: d, index: at, element: point}))
      : chart.config.options.nearest ? [{datasetIndex: meta.index, index: at, element: point}]
      : Chart.Interaction.modes.abreast(chart, {x: point.x, y: point.y, type: 'key', native: null});
    const active = found.map(({datasetIndex, index}) => ({datasetIndex, index}));
    chart.setActiveElements(active);
    chart.tooltip.setActiveElements(active, {x: point.x, y: point.y});
    chart.update('none');
    say.textContent = [...(chart.tooltip.title || []), ...(chart.tooltip.body || []).flatMap(part => part.lines)].join('; ');
  });
  canvas.addEventListener('blur', () => { at = -1; clear(); });
};
const paintLines = chart => {
  for (const dataset of chart.data.datasets) {
    const colour = inkOf(dataset.looks || dataset.entry);
    // Points share what was first resolved for them; what is asked for at every drawing is not shared.
    Object.assign(dataset, {borderColor: colour, backgroundColor: colour, pointBackgroundColor: () => colour, pointBorderColor: () => colour});
  }
};
// What is drawn in ink would vanish on the tooltip's ground.
const labelColour = item => ({borderColor: palette.paper, backgroundColor: item.dataset.borderColor, borderWidth: 1.5, borderRadius: 3});
const readings = (x, y, swap) => ({
  title: items => items.length ? `${x.name} ${withUnit(significant(swap ? items[0].parsed.y : items[0].parsed.x, 3), x.unit)}` : '',
  label: item => `${item.dataset.label}: ${withUnit(significant(swap ? item.parsed.x : item.parsed.y, 4), y.unit)}`,
  labelPointStyle: () => ({pointStyle: 'rectRounded', rotation: 0}),
  labelColor: labelColour,
});

const drawPlot = (block, body) => {
  const logs = {x: block.x.log, y: block.y.log};
  for (const which of ['x', 'y'])
    if (block[which].switch && state.has(`${block.id}.${which}`)) logs[which] = state.get(`${block.id}.${which}`) === 'log';
  let whole = block.focus === null || state.get(`${block.id}.range`) === 'whole';
  const entryOf = curve => curve.entry >= 0 ? entries[curve.entry] : null;
  const looksOf = curve => entryOf(curve) || curve;
  const nearest = block.curves.some(curve => curve.hover.length);
  const values = {x: block.curves.flatMap(curve => curve.x), y: block.curves.flatMap(curve => curve.y.filter(isNumber))};
  const scales = () => {
    const found = {x: scaleOf(block.x, logs.x, values.x), y: scaleOf(block.y, logs.y, values.y)};
    if (!whole && !logs.y) found.y.min = block.focus;
    return found;
  };
  const canvas = element('canvas');
  const holder = element('div', {class: 'canvas' + (block.tall ? ' tall' : '')}, canvas);
  body.append(holder);
  const datasets = block.curves.map(curve => {
    const entry = entryOf(curve);
    return {
      label: curve.name || (entry ? nameOf(entry) : ''), entry, curve, looks: looksOf(curve),
      data: curve.x.map((x, i) => ({x, y: curve.y[i]})), normalized: true,
      showLine: curve.line, borderDash: dashOf(looksOf(curve)), borderWidth: looksOf(curve).colour < 0 ? 1.8 : 2.3,
      pointRadius: curve.marks ? 4.5 : 0, pointHoverRadius: curve.marks ? 7 : 4, pointHitRadius: curve.marks ? 8 : 1,
      tension: 0, spanGaps: false,
      segment: curve.held_from === null ? undefined : {borderDash: c => c.p0.parsed.x >= curve.held_from ? [1, 5] : undefined},
      interval: curve.low.length ? i => [curve.low[i], curve.high[i]] : undefined,
    };
  });
  const tooltip = {callbacks: nearest ? {
    title: items => items.length ? items[0].dataset.label : '',
    label: item => [...(item.dataset.curve.hover[item.dataIndex] || '').split('\n').filter(Boolean),
      `${block.x.name} ${withUnit(significant(item.parsed.x, 3), block.x.unit)}`, `${block.y.name} ${withUnit(significant(item.parsed.y, 3), block.y.unit)}`],
    labelPointStyle: () => ({pointStyle: 'rectRounded', rotation: 0}), labelColor: labelColour,
  } : readings(block.x, block.y, false)};
  const chart = setup(canvas, block, {type: 'line', data: {datasets}, options: {parsing: false, normalized: true, nearest,
    interaction: nearest ? {mode: 'nearest', intersect: false, axis: 'xy'} : {mode: 'abreast', intersect: false}, scales: scales(), plugins: {tooltip}}}, paintLines);
  const rescale = () => { chart.options.scales = scales(); chart.update('none'); };
  const controls = element('div', {class: 'controls'});
  for (const which of ['x', 'y'])
    if (block[which].switch) controls.append(checkbox(`logarithmic ${block[which].name}`, logs[which], log => {
      logs[which] = log;
      remember(`${block.id}.${which}`, log === block[which].log ? null : log ? 'log' : 'linear');
      rescale();
    }));
  if (block.focus !== null) controls.append(checkbox('whole range', whole, checked => {
    whole = checked;
    remember(`${block.id}.range`, checked ? 'whole' : null);
    rescale();
  }));
  const items = [];
  for (const curve of block.curves) {
    const entry = entryOf(curve);
    if (!items.some(item => item.entry === entry && item.name === curve.name)) items.push({entry, looks: looksOf(curve), name: curve.name, marks: curve.marks, line: curve.line});
  }
  body.append(legend(items));
  if (controls.children.length) body.append(controls);
  return {chart, rows: () => {
    const rows = [['curve', axisName(block.x), axisName(block.y), ...(nearest ? ['settings'] : [])]];
    for (const curve of block.curves) {
      const entry = entryOf(curve);
      curve.x.forEach((x, i) => rows.push([curve.name ? (entry ? entry.name + ': ' : '') + curve.name : entry.name, x, curve.y[i], ...(nearest ? [curve.hover[i]] : [])]));
    }
    return rows;
  }};
};

const drawBars = (block, body) => {
  const canvas = element('canvas');
  const lines = block.categories.length * (block.stacked ? 1 : Math.max(1, block.groups.length));
  const holder = element('div', {class: 'canvas bars'}, canvas);
  holder.style.height = `${Math.max(9, 5.5 + 2.1 * lines)}rem`;
  body.append(holder);
  const values = block.groups.flatMap(group => group.values).filter(isNumber);
  const x = scaleOf(block.x, block.x.log, values);
  if (block.x.log) {
    const positive = values.filter(v => v > 0);
    x.min = block.x.from ?? Math.pow(10, Math.floor(Math.log10(Math.min(...positive, Infinity)) - 0.3));
    x.max = block.x.to ?? Math.pow(10, Math.ceil(Math.log10(Math.max(...positive, x.min * 10))));
    x.ticks.callback = decades;
  } else if (!block.stacked) x.beginAtZero = true;
  x.stacked = block.stacked;
  const narrow = window.matchMedia('(max-width: 40rem)').matches;
  const wrapped = text => narrow && text.length > 18 ? text.split(/(?<=.{9,}) /) : text;
  const chart = setup(canvas, block, {type: 'bar',
    data: {labels: block.categories.map(wrapped), datasets: block.groups.map((group, i) => ({label: group.name, data: group.values, backgroundColor: () => palette.lines[i % palette.lines.length], barPercentage: .82, categoryPercentage: .8}))},
    options: {indexAxis: 'y', interaction: {mode: 'nearest', intersect: false, axis: 'y'},
      scales: {x, y: painted({title: {display: false, text: ''}, ticks: {autoSkip: false}, stacked: block.stacked, grid: {display: false}})},
      plugins: {tooltip: {callbacks: {label: item => `${item.dataset.label}: ${withUnit(significant(item.parsed.x, 3), block.x.unit)}`}}}}},
    () => {});
  if (block.groups.length > 1) {
    const key = element('ul', {class: 'legend'});
    const fill = () => key.replaceChildren(...block.groups.map((group, i) => {
      const box = element('span', {class: 'box', 'aria-hidden': 'true'});
      box.style.background = palette.lines[i % palette.lines.length];
      return element('li', {}, element('span', {class: 'key'}, box, group.name));
    }));
    painters.push(fill);
    fill();
    body.append(key);
  }
  return {chart, rows: () => [['', ...block.groups.map(group => `${group.name}${block.x.unit ? ` (${block.x.unit})` : ''}`)],
    ...block.categories.map((name, i) => [name, ...block.groups.map(group => group.values[i])])]};
};

const niceTop = value => { const power = Math.pow(10, Math.floor(Math.log10(value))); return [1, 1.5, 2, 3, 4, 5, 6, 8, 10].map(m => m * power).find(m => m >= value); };
const drawFrames = (block, body) => {
  const {upright} = block;
  const canvas = element('canvas');
  body.append(element('div', {class: 'canvas'}, canvas));
  const all = block.curves.flatMap(curve => curve.values.flatMap(values => values.filter(isNumber)));
  const highest = all.reduce((a, b) => Math.max(a, b), 0), lowest = all.reduce((a, b) => Math.min(a, b), 0);
  // Beyond the material there is nothing to draw.
  const points = (curve, frame) => {
    const values = curve.values[frame];
    let last = values.length;
    if (!upright) while (last > 1 && values[last - 1] === 0 && values[last - 2] === 0) --last;
    return values.slice(0, last).map((v, i) => upright ? {x: v, y: block.coordinate[i]} : {x: block.coordinate[i], y: v});
  };
  const grid = {...scaleOf(block.grid, false, []), min: block.grid.from ?? block.coordinate[0], max: block.grid.to ?? block.coordinate[block.coordinate.length - 1]};
  const value = {...scaleOf(block.value, false, []), min: block.value.from ?? lowest, max: block.value.to ?? undefined};
  if (upright) value.suggestedMax = highest;
  const chart = setup(canvas, block, {type: 'line', data: {datasets: block.curves.map(curve => {
    const entry = entries[curve.entry];
    return {label: nameOf(entry), entry, curve, data: [], borderDash: dashOf(entry), borderWidth: entry.colour < 0 ? 1.8 : 2.3, pointRadius: 0, pointHoverRadius: 4, tension: 0};
  })}, options: {parsing: false, normalized: !upright, upright, interaction: {mode: 'abreast', intersect: false},
    scales: upright ? {x: value, y: grid} : {x: grid, y: value},
    plugins: {tooltip: {callbacks: readings(block.grid, block.value, upright)}}}}, paintLines);
  const when = body.parentElement.querySelector('.when');
  const slider = timeSlider(block, frame => {
    for (const dataset of chart.data.datasets) dataset.data = points(dataset.curve, frame);
    if (when) when.textContent = ' at ' + timeText(block.times[frame]);
    if (!upright && block.value.to === null) {
      // What is left may be a tenth of what began: the scale follows in steps, so that it does not jitter.
      const shown = block.curves.filter(curve => entries[curve.entry].shown);
      const top = shown.reduce((a, curve) => curve.values[frame].reduce((b, v) => Math.max(b, v), a), 0);
      if (top > 0) chart.options.scales.y.max = niceTop(1.05 * top);
    }
    chart.update('none');
  });
  body.append(slider.node, legend(block.curves.map(curve => ({entry: entries[curve.entry]}))));
  slider.start();
  return {chart, rows: () => [['time (s)', axisName(block.grid), ...block.curves.map(curve => entries[curve.entry].name)],
    ...block.times.flatMap((t, f) => block.coordinate.map((x, i) => [t, x, ...block.curves.map(curve => curve.values[f][i])]))]};
};
