// What every part of the page stands on: its data, looks, numbers, and the state kept in the address.
const model = JSON.parse(document.getElementById('data').textContent);
const entries = model.entries.map(entry => ({...entry, shown: true}));
const byId = id => document.getElementById(id);
const element = (tag, attributes = {}, ...children) => {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
  node.append(...children);
  return node;
};

// ---- Looks: Okabe and Ito's palette, told apart by dashes as well. What is exact or measured is drawn in ink.
const palettes = {
  light: {lines: ['#0072b2', '#d55e00', '#009e73', '#b0508a', '#b87e00', '#3a97cf', '#6b5600'], ink: '#1b2430', soft: '#5a6675', grid: '#e3e7ec', panel: '#f6f7f9', paper: '#ffffff'},
  dark: {lines: ['#56b4e9', '#ff9a4d', '#2bc79a', '#e39ac4', '#f0e442', '#8fb8ff', '#d9b38c'], ink: '#e6eaf0', soft: '#9ba7b6', grid: '#2a323d', panel: '#1a2028', paper: '#12161c'},
};
const dashes = [[], [9, 4], [2.5, 3], [12, 3, 3, 3], [6, 2], [1.5, 5], [14, 4, 2, 4, 2, 4], [5, 5]];
const darkQuery = window.matchMedia('(prefers-color-scheme: dark)');
const themes = ['auto', 'light', 'dark'];
let theme = 'auto';
let palette = palettes.light;
const isDark = () => theme === 'dark' || (theme === 'auto' && darkQuery.matches);
const inkOf = entry => !entry || entry.colour < 0 ? palette.ink : palette.lines[entry.colour % palette.lines.length];
const dashOf = entry => entry ? dashes[entry.dash % dashes.length] : [];
const warningOf = entry => [entry.doubt, entry.trouble && 'incomplete'].filter(Boolean).join(', ');
const nameOf = entry => entry.name + (warningOf(entry) ? ` (${warningOf(entry)})` : '');
const badgesOf = entry => [
  ...(entry.doubt ? [element('span', {class: 'badge', title: entry.why}, entry.doubt)] : []),
  ...(entry.trouble ? [element('span', {class: 'badge', title: entry.trouble}, 'incomplete')] : []),
];
const swatch = (entry, marks = false, line = true) => {
  const sample = element('span', {'aria-hidden': 'true', class: 'swatch'});
  const colour = inkOf(entry);
  sample.innerHTML = `<svg width="38" height="10">${line ? `<line x1="1" x2="37" y1="5" y2="5" stroke="${colour}" stroke-width="2.4" stroke-dasharray="${dashOf(entry).join(' ')}"/>` : ''}${marks ? `<circle cx="19" cy="5" r="4" fill="${colour}"/>` : ''}</svg>`;
  return sample;
};

// ---- Numbers
const isNumber = value => typeof value === 'number' && Number.isFinite(value);
const minus = text => text.replace('e-', 'e\u2212').replace(/^-/, '\u2212');
const significant = (value, digits) => {
  if (value === 0) return '0';
  const before = Math.floor(Math.log10(Math.abs(value))) + 1;
  if (before < -4 || before > 9) return minus(value.toExponential(digits - 1));
  return minus(value.toFixed(Math.max(0, digits - before)));
};
const fixed = (value, digits) => minus(value.toFixed(digits).replace(/^-(?=0(\.0*)?$)/, ''));
const formatted = (value, format) => {
  if (format.kind === 'significant') return significant(value, format.digits);
  const text = fixed(value, format.digits);
  return format.kind === 'signed' && value > 0 && /[1-9]/.test(text) ? '+' + text : text;
};
const withUnit = (text, unit) => unit ? text + '\u00a0' + unit : text;
const axisName = axis => axis.unit ? `${axis.name} (${axis.unit})` : axis.name;
const timeText = t => (t < 10 ? Number(t.toFixed(2)) : Number(t.toFixed(1))) + '\u00a0s';
const figureTitle = block => model.title + ': ' + block.title;

// ---- State in the address: #t=10&spread.x=log&theme=dark
const state = new URLSearchParams(location.hash.slice(1));
const remember = (key, value) => {
  if (value === null) state.delete(key); else state.set(key, value);
  const text = state.toString();
  history.replaceState(null, '', text ? '#' + text : location.pathname + location.search);
};

// ---- Who repaints when the theme changes, and who redraws when a run is shown or hidden
const painters = [];
const visibility = [];
const setTheme = dark => {
  palette = dark ? palettes.dark : palettes.light;
  document.documentElement.dataset.theme = dark ? 'dark' : 'light';
};
if (themes.includes(state.get('theme'))) theme = state.get('theme');
setTheme(isDark());
const repaint = dark => { setTheme(dark); for (const paint of painters) paint(); };

// ---- Clocks: figures of the same clock move together
const clocks = new Map();
const clockOf = name => {
  if (!clocks.has(name)) clocks.set(name, {name, time: null, followers: [], playing: null});
  return clocks.get(name);
};
const stateKey = clock => clock.name ? clock.name + '.t' : 't';
const setTime = (clock, time, keep = true) => {
  clock.time = time;
  for (const follow of clock.followers) follow(time);
  if (keep) remember(stateKey(clock), Number(time.toPrecision(6)));
};
const nearestFrame = (times, t) => times.reduce((best, f, i) => Math.abs(f - t) < Math.abs(times[best] - t) ? i : best, 0);

// A slider with a play button for the frames at `times`; `show` draws one of them.
const timeSlider = (block, show) => {
  const {times} = block;
  const clock = clockOf(block.clock);
  const slider = element('input', {type: 'range', min: 0, max: times.length - 1, step: 1, 'aria-label': 'Time: ' + block.title});
  const play = element('button', {type: 'button', 'aria-pressed': 'false', class: 'play'}, 'Play');
  const shown = element('output');
  const follow = time => {
    const frame = nearestFrame(times, time);
    slider.value = frame;
    const text = timeText(times[frame]);
    shown.textContent = text;
    slider.setAttribute('aria-valuetext', text);
    show(frame);
  };
  const stop = () => {
    if (!clock.playing) return;
    clearInterval(clock.playing.timer);
    clock.playing.button.textContent = 'Play';
    clock.playing.button.setAttribute('aria-pressed', 'false');
    clock.playing = null;
    remember(stateKey(clock), Number(clock.time.toPrecision(6)));
  };
  slider.addEventListener('input', () => { stop(); setTime(clock, times[slider.value]); });
  play.addEventListener('click', () => {
    if (clock.playing) { stop(); return; }
    if (Number(slider.value) >= times.length - 1) setTime(clock, times[0], false);
    play.textContent = 'Pause';
    play.setAttribute('aria-pressed', 'true');
    const timer = setInterval(() => {
      if (Number(slider.value) >= times.length - 1) stop(); else setTime(clock, times[Number(slider.value) + 1], false);
    }, Math.min(250, Math.max(70, 9000 / times.length)));
    clock.playing = {timer, button: play};
  });
  clock.followers.push(follow);
  if (clock.time === null) {
    const wanted = Number(state.get(stateKey(clock)));
    clock.time = state.has(stateKey(clock)) && Number.isFinite(wanted) ? wanted : times[times.length - 1];
  }
  return {node: element('div', {class: 'slider controls'}, play, slider, shown), start: () => follow(clock.time)};
};

const checkbox = (text, checked, change) => {
  const box = element('input', {type: 'checkbox'});
  box.checked = checked;
  box.addEventListener('change', () => change(box.checked));
  return element('label', {}, box, text);
};

// The legend of a figure: a button a run, which shows and hides it in every figure of the page.
const legend = items => {
  const node = element('ul', {class: 'legend', 'aria-label': 'Legend'});
  const fill = () => node.replaceChildren(...items.map(({entry, looks, name, marks, line}) => {
    const parts = [swatch(looks || entry, marks, line), element('span', {}, name || entry.name), ...(entry && !name ? badgesOf(entry) : [])];
    if (!entry) return element('li', {}, element('span', {class: 'key'}, ...parts));
    const button = element('button', {type: 'button', class: 'key', 'aria-pressed': String(entry.shown), title: entry.shown ? 'Hide in every figure' : 'Show in every figure'}, ...parts);
    button.addEventListener('click', () => {
      entry.shown = !entry.shown;
      for (const update of visibility) update();
      const again = [...node.querySelectorAll('button')].find(other => other.textContent === button.textContent);
      if (again) again.focus();
    });
    return element('li', {}, button);
  }));
  painters.push(fill);
  visibility.push(fill);
  fill();
  return node;
};
