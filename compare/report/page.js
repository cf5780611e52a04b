'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const comparison = data.comparison;
  const slump = comparison.kind === 'slump';
  const runs = comparison.runs.map((run, i) => ({...run, ...data.runs[i], shown: true}));
  const byId = id => document.getElementById(id);

  // ---- Looks: Okabe and Ito's palette, told apart by dashes as well. Exact solutions are drawn in ink.
  const palettes = {
    light: {lines: ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#8a6d00'], ink: '#1b2430', soft: '#5a6675', grid: '#dce1e7', panel: '#f6f7f9'},
    dark: {lines: ['#56b4e9', '#e69f00', '#2bc79a', '#e39ac4', '#f0e442', '#ff8a3d', '#8fb8ff'], ink: '#e6eaf0', soft: '#9ba7b6', grid: '#303945', panel: '#1a2028'},
  };
  const dashes = [[], [9, 4], [3, 3], [12, 3, 3, 3], [6, 2], [2, 5], [14, 4, 2, 4, 2, 4]];
  const exactDashes = [[1, 4], [7, 3, 1, 3], [4, 4]];
  const darkQuery = window.matchMedia('(prefers-color-scheme: dark)');
  let palette = darkQuery.matches ? palettes.dark : palettes.light;
  let computed = 0, exact = 0;
  for (const run of runs) {
    if (run.exact) run.dash = exactDashes[exact++ % exactDashes.length];
    else { run.colour = computed; run.dash = dashes[computed++ % dashes.length]; }
    run.name = run.label + (run.noisy ? ' (noisy)' : '') + (run.trouble ? ' (incomplete)' : '');
  }
  const colourOf = run => run.exact ? palette.ink : palette.lines[run.colour % palette.lines.length];

  // ---- Numbers
  const isNumber = value => typeof value === 'number' && Number.isFinite(value);
  const significant = (value, digits) => {
    if (value === 0) return '0';
    const before = Math.floor(Math.log10(Math.abs(value))) + 1;
    if (before < -5 || before > 9) return value.toExponential(digits - 1).replace('e-', 'e\u2212');
    return value.toFixed(Math.max(0, digits - before)).replace('-', '\u2212');
  };
  const fixed = digits => value => value.toFixed(digits).replace(/^-(?=0\.?0*$)/, '').replace('-', '\u2212');
  const signed = digits => value => { const text = fixed(digits)(value); return /[1-9]/.test(text) && value > 0 ? '+' + text : text; };
  const to = digits => value => significant(value, digits);
  const shortTime = t => (t < 10 ? Number(t.toFixed(2)) : Number(t.toFixed(1))) + ' s';
  const capital = text => text[0].toUpperCase() + text.slice(1);

  const element = (tag, attributes = {}, ...children) => {
    const node = document.createElement(tag);
    for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
    node.append(...children);
    return node;
  };

  // ---- State in the address: #t=10&axis=log
  const state = new URLSearchParams(location.hash.slice(1));
  const remember = (key, value) => {
    if (value === null) state.delete(key); else state.set(key, value);
    history.replaceState(null, '', '#' + state.toString());
  };

  // ---- Charts
  const charts = [];
  Chart.defaults.font.family = getComputedStyle(document.documentElement).fontFamily;
  Chart.defaults.animation = false;
  const lineDataset = (run, points, extra = {}) => ({
    label: run.name, data: points, borderDash: run.dash, borderWidth: run.exact ? 1.8 : 2.4, pointRadius: 0,
    pointHoverRadius: 4, pointStyle: 'line', tension: 0, spanGaps: false, run, hidden: !run.shown, ...extra,
  });
  const zip = (xs, ys) => xs.map((x, i) => ({x, y: isNumber(ys[i]) ? ys[i] : null}));
  const axis = (text, extra = {}) => ({title: {display: true, text}, ...extra});
  const paint = chart => {
    const {options} = chart;
    for (const dataset of chart.data.datasets) {
      if (!dataset.run) continue;
      const colour = colourOf(dataset.run);
      dataset.borderColor = colour;
      dataset.pointBackgroundColor = colour;
    }
    options.color = palette.ink;
    options.plugins.title.color = palette.ink;
    options.plugins.legend.labels.color = palette.ink;
    for (const scale of Object.values(options.scales)) {
      scale.grid = {...scale.grid, color: palette.grid, borderColor: palette.soft};
      scale.ticks = {...scale.ticks, color: palette.soft};
      scale.title.color = palette.ink;
    }
  };
  // Exported or copied as an image, a chart keeps its ground.
  const ground = {id: 'ground', beforeDraw: chart => {
    chart.ctx.save();
    chart.ctx.fillStyle = palette.panel;
    chart.ctx.fillRect(0, 0, chart.width, chart.height);
    chart.ctx.restore();
  }};
  // Chart.js leaves the dashes out of its line symbols.
  const dashedLabels = chart => Chart.defaults.plugins.legend.labels.generateLabels(chart).map(label =>
    ({...label, lineDash: chart.data.datasets[label.datasetIndex].borderDash, lineWidth: 2.4}));
  const draw = (id, type, title, datasets, scales, options = {}) => {
    const canvas = byId(id);
    const full = comparison.title + ': ' + title;
    canvas.setAttribute('aria-label', full);
    const chart = new Chart(canvas, {
      type, data: {labels: options.labels, datasets}, plugins: [ground],
      options: {
        responsive: true, maintainAspectRatio: false, normalized: true, parsing: options.labels ? undefined : false,
        indexAxis: options.labels ? 'y' : 'x',
        interaction: {mode: options.labels ? 'nearest' : 'index', intersect: false, axis: options.labels ? 'y' : 'x'},
        scales,
        plugins: {
          title: {display: true, text: full, align: 'start', font: {size: 14, weight: '600'}, padding: {bottom: 8}},
          legend: {display: options.legend !== false, position: 'bottom', align: 'start',
            labels: {usePointStyle: !options.labels, pointStyleWidth: 40, boxHeight: 7, padding: 12, ...(options.labels ? {} : {generateLabels: dashedLabels})}},
          tooltip: {usePointStyle: !options.labels, callbacks: options.tooltip || {}},
        },
      },
    });
    paint(chart);
    chart.update();
    charts.push(chart);
    return chart;
  };
  const hide = id => { byId(id).hidden = true; };
  const repaint = () => { for (const chart of charts) { paint(chart); chart.update(); } drawSwatches(); };

  // ---- Which runs are shown
  const swatches = [];
  const drawSwatches = () => swatches.forEach(({line, run}) => line.setAttribute('stroke', colourOf(run)));
  for (const run of runs) {
    const box = element('input', {type: 'checkbox'});
    box.checked = true;
    box.addEventListener('change', () => {
      run.shown = box.checked;
      for (const chart of charts) {
        chart.data.datasets.forEach((dataset, i) => { if (dataset.run === run) chart.setDatasetVisibility(i, run.shown); });
        chart.update();
      }
    });
    const sample = element('span', {'aria-hidden': 'true'});
    sample.innerHTML = '<svg width="44" height="10"><line x1="1" x2="43" y1="5" y2="5" stroke-width="2.6"/></svg>';
    const line = sample.querySelector('line');
    line.setAttribute('stroke-dasharray', run.dash.join(' '));
    swatches.push({line, run});
    const label = element('label', {}, box, sample, element('span', {}, run.label));
    if (run.noisy) label.append(element('span', {class: 'badge', title: run.verdict}, 'noisy'));
    if (run.trouble) label.append(element('span', {class: 'badge', title: run.trouble}, 'incomplete'));
    byId('runs').append(label);
  }
  drawSwatches();

  // ---- The gauge against time
  const gaugeTitle = data.gauge.name + ' against time';
  const heldDash = run => isNumber(run.held_from) ? {segment: {borderDash: c => c.p0.parsed.x >= run.held_from ? [1, 5] : undefined}} : {};
  const timeScale = log => log
    ? axis('time (s, logarithmic)', {type: 'logarithmic', min: Math.max(data.end / 1000, data.time[1] || data.end / 1000), max: data.end,
        ticks: {autoSkip: false, maxRotation: 0, callback: v => [1, 2, 5].includes(Number(v.toExponential(0)[0])) ? String(Number(v.toPrecision(1))) : ''}})
    : axis('time (s)', {type: 'linear', min: 0, max: data.end});
  const timeTip = {title: items => 't = ' + shortTime(items[0].parsed.x),
    label: item => isNumber(item.parsed.y) ? `${item.dataset.label}: ${significant(item.parsed.y, 4)} ${data.gauge.unit}` : ''};
  const gaugeChart = draw('chart-gauge', 'line', gaugeTitle,
    runs.map(run => lineDataset(run, zip(data.time, run.gauge), heldDash(run))),
    {x: timeScale(false), y: axis(`${data.gauge.name} (${data.gauge.unit})`)}, {tooltip: timeTip});
  byId('caption-gauge').textContent = slump
    ? 'Spread: twice the radius at which the depth falls through 3 mm. A thin dotted tail continues a run that has come to rest.'
    : 'Velocity of the plug. The exact line is the steady state of each stage of the force.';
  const logBox = byId('log-time');
  const setLog = log => {
    logBox.checked = log;
    gaugeChart.options.scales.x = timeScale(log);
    paint(gaugeChart);
    gaugeChart.update();
  };
  // A slump's whole rise hides what matters: how its runs part at the end.
  const wholeBox = byId('whole');
  const ends = runs.map(run => [...run.gauge].reverse().find(isNumber)).filter(isNumber);
  const setWhole = whole => {
    wholeBox.checked = whole;
    gaugeChart.options.scales.y.min = whole || !slump || !ends.length ? undefined : 10 * Math.floor(0.9 * Math.min(...ends) / 10);
    gaugeChart.options.scales.y.beginAtZero = whole || !slump;
    gaugeChart.update();
  };
  if (!slump) wholeBox.parentElement.hidden = true;
  wholeBox.addEventListener('change', () => { setWhole(wholeBox.checked); remember('range', wholeBox.checked ? 'whole' : null); });
  setWhole(state.get('range') === 'whole');
  logBox.addEventListener('change', () => { setLog(logBox.checked); remember('axis', logBox.checked ? 'log' : null); });
  if (state.get('axis') === 'log') setLog(true);

  // ---- Profiles with a slider
  if (runs.some(run => run.profiles.some(profile => profile))) {
    const across = !slump;  // a duct is drawn upright: velocity to the right, height upwards
    const points = (run, frame) => {
      const values = run.profiles[frame];
      if (!values) return [];
      // Beyond the material there is nothing to draw.
      let last = values.length;
      if (slump) while (last > 1 && values[last - 1] === 0 && values[last - 2] === 0) --last;
      return values.slice(0, last).map((v, i) => across ? {x: v, y: data.grid[i]} : {x: data.grid[i], y: v});
    };
    const highest = Math.max(...runs.flatMap(run => run.profiles.flatMap(p => p || [])));
    const widest = data.grid[data.grid.length - 1];
    const x = across ? axis(`velocity (${data.value.unit})`, {type: 'linear', min: 0, suggestedMax: highest})
      : axis(`${data.coordinate.name} (mm)`, {type: 'linear', min: 0, max: widest});
    const y = across ? axis(`${data.coordinate.name} (mm)`, {type: 'linear', min: data.grid[0], max: widest})
      : axis(`depth (${data.value.unit})`, {type: 'linear', beginAtZero: true});
    const chart = draw('chart-profiles', 'line', `${data.value.name} profiles`, runs.map(run => lineDataset(run, [])), {x, y},
      {tooltip: {title: items => across ? '' : `${data.coordinate.name} ${fixed(1)(items[0].parsed.x)} mm`,
        label: item => `${item.dataset.label}: ${significant(across ? item.parsed.x : item.parsed.y, 3)} ${data.value.unit}`}});
    if (across) chart.options.interaction = {mode: 'nearest', intersect: false, axis: 'y'};
    const slider = byId('time'), play = byId('play'), shown = byId('time-shown');
    slider.max = data.frames.length - 1;
    const show = frame => {
      slider.value = frame;
      const text = shortTime(data.frames[frame]);
      shown.textContent = text;
      slider.setAttribute('aria-valuetext', text);
      chart.data.datasets.forEach(dataset => { dataset.data = points(dataset.run, frame); });
      chart.options.plugins.title.text = `${comparison.title}: ${data.value.name} profiles at ${text}`;
      if (slump) {
        // The cone is ten times as deep as what it leaves: the scale follows in steps, so that it does not jitter.
        const top = Math.max(1, ...runs.filter(r => r.shown).map(r => r.profiles[frame] ? Math.max(...r.profiles[frame]) : 0));
        chart.options.scales.y.max = [10, 20, 50, 75, 100, 150, 200, 300, 400, 600, 1000].find(m => m >= 1.05 * top);
      }
      chart.update();
    };
    const nearest = t => data.frames.reduce((best, f, i) => Math.abs(f - t) < Math.abs(data.frames[best] - t) ? i : best, 0);
    let timer = null;
    const pause = () => { clearInterval(timer); timer = null; play.textContent = 'Play'; play.setAttribute('aria-pressed', 'false'); remember('t', data.frames[slider.value]); };
    play.addEventListener('click', () => {
      if (timer !== null) { pause(); return; }
      if (Number(slider.value) >= data.frames.length - 1) show(0);
      play.textContent = 'Pause';
      play.setAttribute('aria-pressed', 'true');
      timer = setInterval(() => {
        if (Number(slider.value) >= data.frames.length - 1) pause(); else show(Number(slider.value) + 1);
      }, 90);
    });
    slider.addEventListener('input', () => { if (timer !== null) pause(); show(Number(slider.value)); remember('t', data.frames[slider.value]); });
    const wanted = Number(state.get('t'));
    show(state.has('t') && Number.isFinite(wanted) ? nearest(wanted) : data.frames.length - 1);
    byId('caption-profiles').textContent = slump
      ? 'Depth: concrete volume per plan area, for every solver. Vertical scale exaggerated. Drag, use the arrow keys, or press play.'
      : 'Drag, use the arrow keys, or press play.';
  } else hide('section-profiles');

  // ---- Tables that sort
  const table = (id, columns, rows) => {
    const node = byId(id);
    const body = element('tbody');
    const used = columns.filter(column => column.always || rows.some(row => { const v = column.value(row); return v !== null && v !== undefined && v !== ''; }));
    const cellOf = (column, row, first) => {
      const value = column.value(row);
      const text = isNumber(value) ? (column.format || to(3))(value) : value === null || value === undefined || value === '' ? '\u2013' : String(value);
      const cell = first ? element('th', {scope: 'row'}, text) : element('td', column.text ? {class: 'text'} : {}, text);
      if (first && row.noisy) cell.append(' ', element('span', {class: 'badge'}, 'noisy'));
      if (first && row.trouble) cell.append(' ', element('span', {class: 'badge'}, 'incomplete'));
      return cell;
    };
    const fill = () => body.replaceChildren(...rows.map(row => element('tr', {}, ...used.map((column, i) => cellOf(column, row, i === 0)))));
    const head = element('tr');
    used.forEach((column, i) => {
      const button = element('button', {type: 'button'}, column.name);
      if (column.unit) button.append(' ', element('span', {class: 'unit'}, '(' + column.unit + ')'));
      const cell = element('th', {scope: 'col', ...(column.text || i === 0 ? {class: 'text'} : {})}, button);
      button.addEventListener('click', () => {
        const down = cell.getAttribute('aria-sort') === 'ascending';
        for (const other of head.children) other.removeAttribute('aria-sort');
        cell.setAttribute('aria-sort', down ? 'descending' : 'ascending');
        const order = (a, b) => {
          const left = column.value(a), right = column.value(b);
          if (isNumber(left) && isNumber(right)) return left - right;
          if (isNumber(left) !== isNumber(right)) return isNumber(left) ? -1 : 1;
          return String(left ?? '').localeCompare(String(right ?? ''));
        };
        rows.sort((a, b) => down ? order(b, a) : order(a, b));
        fill();
      });
      head.append(cell);
    });
    fill();
    node.replaceChildren(element('thead', {}, head), body);
  };
  const measure = key => run => run.measures[key];
  const overshoots = comparison.measure_columns.filter(name => name.startsWith('overshoot_at_'));
  const nameColumn = {name: 'Run', value: run => run.label, always: true};
  const trust = {name: 'Verdict', text: true, value: run => run.exact ? 'exact' : [run.trouble, run.verdict].filter(Boolean).join('; ')};
  table('table-measures', slump ? [
    nameColumn,
    {name: 'Spread at the end', unit: 'mm', format: fixed(0), value: measure('spread_end_mm')},
    {name: 'at 1.5 mm depth', unit: 'mm', format: fixed(0), value: measure('spread_end_at_1.5mm_mm')},
    {name: 'at 6 mm depth', unit: 'mm', format: fixed(0), value: measure('spread_end_at_6mm_mm')},
    {name: 'Centre', unit: 'mm', format: fixed(1), value: measure('centre_end_mm')},
    {name: 'Recorded until', unit: 's', format: fixed(0), value: run => run.exact ? null : run.measures.end_s},
    {name: 'Rest, declared', unit: 's', format: fixed(1), value: measure('rest_declared_s')},
    {name: 'Still to come, at most', unit: 'mm', format: fixed(1), value: measure('growth_to_come_mm')},
    {name: 'Rest by shear rate', unit: 's', format: fixed(1), value: measure('rest_by_shear_rate_s')},
    {name: 'Rest by spread rate', unit: 's', format: fixed(1), value: measure('rest_by_spread_rate_s')},
    ...overshoots.map(key => ({name: 'Past the arrested spread at ' + key.match(/at_(.+)s_mm/)[1] + ' s', unit: 'mm', format: signed(0), value: measure(key)})),
    {name: 'Volume drift', unit: '%', format: signed(3), value: run => isNumber(run.measures.volume_drift) ? 100 * run.measures.volume_drift : null},
    trust,
  ] : [
    nameColumn,
    {name: 'Plug velocity at the end', unit: 'm/s', format: to(4), value: measure('plug_velocity_end_m_s')},
    {name: 'Stops after the last change of force', unit: 's', format: fixed(2), value: measure('stop_after_step_s')},
    {name: 'Exact bound', unit: 's', format: fixed(2), value: measure('stopping_time_bound_s')},
    {name: 'Rest by shear rate', unit: 's', format: fixed(2), value: measure('rest_by_shear_rate_s')},
    trust,
  ], [...runs]);
  const limits = comparison.thresholds;
  const references = [...new Set(runs.map(run => run.measures.overshoot_reference_run).filter(Boolean))];
  byId('thresholds').textContent = slump
    ? `A run is at rest by shear rate once the 99th percentile of the shear rate stays below ${limits.rest_shear_rate_p99_1_s} 1/s, and by spread rate ` +
      `once the spread grows by less than ${limits.rest_spread_rate_mm_s} mm/s over ${limits.rate_window_s} s, up to the end of its record. A dash: not measured, or never. These thresholds are customary, not criteria: a fluid that creeps for ever passes them too. ` +
      'The volume of a material point run includes its elastic compression. ' +
      (references.length ? `Arrested spread: that of ${references.join(', and of ')}.` : 'No run of the elasto-viscoplastic law is among these, so there is no arrested spread to count from.')
    : `A duct has stopped once its plug stays below ${100 * limits.rest_velocity_fraction} % of its largest velocity. A dash: not measured, or never.`;

  // ---- Residual speed
  const residualKey = slump ? 'residual_mm_s' : 'residual_m_s', creepKey = slump ? 'predicted_creep_mm_s' : 'predicted_creep_m_s';
  const residualUnit = slump ? 'mm/s' : 'm/s';
  const moving = runs.filter(run => !run.exact && isNumber(run.measures[residualKey]));
  if (moving.length) {
    const values = moving.flatMap(run => [Math.abs(run.measures[residualKey]), run.measures[creepKey]]).filter(v => v > 0);
    const floor = Math.pow(10, Math.floor(Math.log10(Math.max(Math.min(...values, 1), slump ? 1e-5 : 1e-8))));
    const chart = draw('chart-residual', 'bar', slump ? 'growth of the spread over the last seconds' : 'plug velocity over the last seconds', [
      {label: 'measured', data: moving.map(run => Math.max(Math.abs(run.measures[residualKey]), floor)), barPercentage: .8},
      {label: 'predicted by the regularisation alone', data: moving.map(run => run.measures[creepKey] > 0 ? run.measures[creepKey] : null), barPercentage: .8},
    ], {x: axis(`speed (${residualUnit}, logarithmic)`, {type: 'logarithmic', min: floor, max: Math.pow(10, Math.ceil(Math.log10(Math.max(...values, floor * 10)))),
          ticks: {callback: v => /^1(?:e|$)/.test(v.toExponential()) ? String(Number(v.toPrecision(1))) : ''}}),
        y: axis('', {ticks: {autoSkip: false}})},
      {labels: moving.map(run => run.name), tooltip: {label: item => `${item.dataset.label}: ${significant(item.parsed.x, 2)} ${residualUnit}`}});
    const colourBars = () => {
      chart.data.datasets[0].backgroundColor = palette.lines[0];
      chart.data.datasets[1].backgroundColor = palette.lines[1];
    };
    chart.colourBars = colourBars;
    colourBars();
    chart.update();
    byId('caption-residual').textContent = slump
      ? `Measured: the median slope of the spread over the last ${limits.residual_window_s} s. Predicted: on the arrested profile, whose base carries the yield stress, the law gives a depth-mean velocity u at half the radius; a shape that stays similar then grows in diameter by 4 u. Past the arrested radius the base stress falls with its fifth power, and the creep with it. A run of a law that comes to rest has no predicted creep.`
      : 'Predicted: the steady velocity of the regularised law under the last force, from its flow curve.';
    table('table-residual', [
      nameColumn,
      {name: 'Measured', unit: residualUnit, format: to(2), value: measure(residualKey)},
      {name: 'Predicted creep', unit: residualUnit, format: to(2), value: run => run.measures[creepKey]},
      {name: 'Ratio', format: to(2), value: run => run.measures[creepKey] > 0 ? Math.abs(run.measures[residualKey]) / run.measures[creepKey] : null},
      {name: 'Scatter', unit: slump ? 'mm' : 'm/s', format: to(2), value: measure(slump ? 'residual_scatter_mm' : 'residual_scatter_m_s')},
      {name: 'Cause', text: true, value: measure('residual_cause')},
      {name: 'Noise monitor', text: true, value: run => run.verdict},
    ], [...moving]);
  } else hide('section-residual');

  // ---- Shear rate
  const sheared = runs.filter(run => run.shear_rate.some(isNumber));
  if (sheared.length) {
    draw('chart-shear', 'line', '99th percentile of the shear rate', sheared.map(run => lineDataset(run, zip(data.time, run.shear_rate).filter(p => p.y > 0))),
      {x: timeScale(true), y: axis('shear rate (1/s, logarithmic)', {type: 'logarithmic', ticks: {callback: v => /^1(?:e|$)/.test(v.toExponential()) ? String(Number(v.toPrecision(1))) : ''}})},
      {tooltip: {title: timeTip.title, label: item => `${item.dataset.label}: ${significant(item.parsed.y, 2)} 1/s`}}).options.interaction.mode = 'x';
    byId('caption-shear').textContent = `Norm: sqrt(2 D:D). The threshold of rest is ${limits.rest_shear_rate_p99_1_s} 1/s.`;
  } else hide('section-shear');

  // ---- Arbitrary stops
  const stops = comparison.arbitrary_stops;
  const stopKey = slump ? 'spread_mm' : 'plug_velocity_m_s';
  if (stops.time_s.length > 1) {
    const own = stops.runs.map(entry => ({...entry, values: entry[stopKey], run: runs.find(run => run.label === entry.label)}));
    const base = run => slump ? run.measures.overshoot_reference_mm ?? run.measures.spread_end_mm : 0;
    draw('chart-stops', 'line', slump ? 'what is read if the run is cut at a time' : 'plug velocity if the run is cut at a time',
      own.map(({run, values}) => lineDataset(run, zip(stops.time_s, values.map(v => isNumber(v) ? v - base(run) : null)), heldDash(run))),
      {x: axis('time of the stop (s)', {type: 'linear', min: stops.time_s[0], max: stops.time_s[stops.time_s.length - 1]}),
       y: axis(slump ? 'spread less the arrested one (mm)' : 'plug velocity (m/s)', {type: 'linear'})},
      {tooltip: {title: items => 'stopped at ' + shortTime(items[0].parsed.x), label: item => `${item.dataset.label}: ${slump ? signed(1)(item.parsed.y) : significant(item.parsed.y, 3)} ${slump ? 'mm' : 'm/s'}`}});
    byId('caption-stops').textContent = slump
      ? 'Counted from the arrested spread of the elasto-viscoplastic run of the same solver where there is one, else of any solver, else from the run\u2019s own end. A level line needs no choice of when to stop; the slope of any other is the error that choice makes.'
      : 'A run that has come to rest needs no choice of when to stop.';
    const unit = slump ? 'mm' : 'm/s', format = slump ? fixed(0) : to(3);
    const rows = own.filter(entry => entry.values.some(isNumber)).map(entry => {
      const values = entry.values.filter(isNumber);
      return {...entry.run, low: Math.min(...values), high: Math.max(...values), base: base(entry.run)};
    });
    table('table-stops', [
      nameColumn,
      {name: 'Lowest reading', unit, format, value: row => row.low},
      {name: 'Highest reading', unit, format, value: row => row.high},
      {name: 'Range', unit, format, value: row => row.high - row.low},
      ...(slump ? [{name: 'Range of the arrested spread', unit: '%', format: fixed(1), value: row => 100 * (row.high - row.low) / row.base}] : []),
    ], rows);
  } else hide('section-stops');

  // ---- Pairs
  if (comparison.pairs.length) {
    const times = [...new Set(comparison.pairs.flatMap(pair => pair.at.map(at => at.time_s)))].sort((a, b) => a - b);
    const select = byId('pair-time');
    for (const t of times) select.append(element('option', {value: t}, shortTime(t)));
    const unit = slump ? 'mm' : 'm/s', suffix = slump ? '_mm' : '_m_s';
    const differs = {law: 'law', solver: 'solver', both: 'law and solver', settings: 'settings', exact: 'exact solution'};
    const show = time => table('table-pairs', [
      {name: 'Run', value: row => row.run, always: true},
      {name: 'against', text: true, value: row => row.reference},
      {name: 'Differs in', text: true, value: row => differs[row.differs_in]},
      {name: slump ? 'Spread' : 'Plug velocity', unit, format: slump ? signed(0) : to(3), value: row => row[(slump ? 'spread' : 'plug_velocity') + '_difference' + suffix]},
      {name: 'L1', unit, format: slump ? fixed(2) : to(3), value: row => row['l1' + suffix]},
      {name: 'L2', unit, format: slump ? fixed(2) : to(3), value: row => row['l2' + suffix]},
      {name: 'L\u221e', unit, format: slump ? fixed(1) : to(3), value: row => row['linf' + suffix]},
      {name: slump ? 'Volume that lies elsewhere' : 'L1, relative', unit: '%', format: to(2), value: row => 100 * row.l1_relative},
      {name: 'L2, relative', unit: '%', format: to(2), value: row => 100 * row.l2_relative},
    ], comparison.pairs.flatMap(pair => pair.at.filter(at => at.time_s === time).map(at => ({...pair, ...at,
        noisy: runs.some(run => run.noisy && run.label === pair.run), trouble: ''}))));
    select.value = times[times.length - 1];
    show(times[times.length - 1]);
    select.addEventListener('change', () => show(Number(select.value)));
    byId('caption-pairs').textContent = slump
      ? 'Norms of the difference in depth on a common radius grid, weighted by plan area over all that either run covers: L1 the mean, L2 the root of the mean square, L\u221e the largest.'
      : 'Norms of the difference in velocity on a common grid: L1 the mean, L2 the root of the mean square, L\u221e the largest.';
  } else hide('section-pairs');

  // ---- Cost
  const priced = runs.filter(run => isNumber(run.measures.cpu_s) && !run.exact);
  if (priced.length) {
    const chart = draw('chart-cost', 'bar', 'CPU time of each run', [{label: 'CPU time', data: priced.map(run => run.measures.cpu_s), barPercentage: .7}],
      {x: axis('CPU time (s)', {type: 'linear', beginAtZero: true}), y: axis('', {ticks: {autoSkip: false}})},
      {labels: priced.map(run => run.name), legend: false, tooltip: {label: item => `${significant(item.parsed.x, 3)} s`}});
    chart.colourBars = () => { chart.data.datasets[0].backgroundColor = palette.lines[2]; };
    chart.colourBars();
    chart.update();
    byId('caption-cost').textContent = 'CPU seconds summed over all threads, on the machine named under Provenance.';
    table('table-cost', [
      nameColumn,
      {name: 'CPU time', unit: 's', format: to(3), value: measure('cpu_s')},
      {name: 'Wall time', unit: 's', format: to(3), value: measure('wall_s')},
      {name: 'CPU per simulated second', unit: 's', format: to(3), value: measure('cpu_s_per_simulated_s')},
      {name: 'Steps', format: fixed(0), value: run => run.made_by && run.made_by.steps},
      {name: 'Particles', format: fixed(0), value: run => run.made_by && run.made_by.particles},
      {name: 'Cells', format: fixed(0), value: run => run.made_by && run.made_by.cells},
      {name: 'Particle-steps or cell-steps per CPU second', format: to(3), value: run => run.made_by.particle_steps_per_cpu_s ?? run.made_by.cell_steps_per_cpu_s},
    ], [...priced]);
  } else hide('section-cost');

  // ---- Downloads, made of the data of this page
  const csvText = text => '"' + String(text).replaceAll('"', '""') + '"';
  const offer = (name, type, text) => byId('downloads').append(
    element('a', {download: name, href: URL.createObjectURL(new Blob([text], {type}))}, name));
  const columnsCsv = (first, xs, key) => [[first, ...runs.map(run => csvText(run.label))].join(','),
    ...xs.map((x, i) => [x, ...runs.map(run => run[key][i] ?? '')].join(','))].join('\n') + '\n';
  const measuresCsv = () => [['run', ...comparison.measure_columns].join(','), ...runs.map(run => [csvText(run.label),
    ...comparison.measure_columns.map(key => typeof run.measures[key] === 'string' ? csvText(run.measures[key]) : run.measures[key] ?? '')].join(','))].join('\n') + '\n';
  const profilesCsv = () => ['time_s,' + (slump ? 'r_mm' : 'y_mm') + ',' + runs.map(run => csvText(run.label)).join(','),
    ...data.frames.flatMap((t, f) => data.grid.map((x, i) => [t, x, ...runs.map(run => run.profiles[f] ? run.profiles[f][i] ?? '' : '')].join(',')))].join('\n') + '\n';
  offer('comparison.json', 'application/json', JSON.stringify(comparison, null, 2));
  offer('measures.csv', 'text/csv', measuresCsv());
  offer(slump ? 'spread.csv' : 'velocity.csv', 'text/csv', columnsCsv('time_s', data.time, 'gauge'));
  offer('profiles.csv', 'text/csv', profilesCsv());

  // ---- Provenance
  const flatten = (object, prefix = '') => Object.entries(object).flatMap(([key, value]) =>
    value !== null && typeof value === 'object' && !Array.isArray(value) ? flatten(value, prefix + key + ' ') : [[prefix + key, value]]);
  const list = entries => element('dl', {}, ...entries.flatMap(([key, value]) => [element('dt', {}, key.replaceAll('_', ' ')), element('dd', {}, String(value))]));
  for (const run of runs) {
    byId('provenance').append(element('details', {}, element('summary', {}, run.label),
      list([['folder', run.directory], ['status', run.status + (run.reason ? ': ' + run.reason : '')], ['verdict', run.verdict || 'none'],
        ...flatten(run.made_by || {})])));
  }
  if (data.scene) byId('provenance').append(element('details', {}, element('summary', {}, 'The scene, as read'), element('pre', {}, data.scene)));
  const made = comparison.provenance;
  byId('made').textContent = `Made by flowrest ${made.flowrest} (${made.git_hash.slice(0, 12)}${made.git_dirty ? ', modified' : ''}) at ${made.written}. ` +
    `Charts by Chart.js ${Chart.version}.`;

  // ---- Light, dark and paper
  const theme = next => { palette = next; for (const chart of charts) if (chart.colourBars) chart.colourBars(); repaint(); };
  darkQuery.addEventListener('change', () => theme(darkQuery.matches ? palettes.dark : palettes.light));
  window.addEventListener('beforeprint', () => { theme({...palettes.light, panel: '#ffffff'}); for (const chart of charts) chart.resize(); });
  window.addEventListener('afterprint', () => { theme(darkQuery.matches ? palettes.dark : palettes.light); for (const chart of charts) chart.resize(); });
  document.documentElement.dataset.drawn = charts.length;
})();
