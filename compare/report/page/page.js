// Draws every figure when it comes near the window, and offers its data.
const drawers = {plot: drawPlot, bars: drawBars, frames: drawFrames, section: drawSection, table: drawTable, map: drawMap};
const figures = [...document.querySelectorAll('figure[data-block]')].map(node => {
  const block = model.blocks[Number(node.dataset.block)];
  return {node, block, drawn: null};
});
const root = document.documentElement;
const drawFigure = figure => {
  if (figure.drawn) return figure.drawn;
  figure.drawn = drawers[figure.block.type](figure.block, figure.node.querySelector('.body'));
  root.dataset.drawn = figures.filter(other => other.drawn).length;
  return figure.drawn;
};

// ---- Downloads, made of the data of this page
const csvCell = value => typeof value === 'string' ? (/[",\n]/.test(value) ? '"' + value.replaceAll('"', '""') + '"' : value) : isNumber(value) ? String(value) : '';
const csvOf = rows => rows.map(row => row.map(csvCell).join(',')).join('\n') + '\n';
const jsonOf = (figure, rows) => JSON.stringify({title: figureTitle(figure.block), caption: figure.block.caption || '', columns: rows[0], rows: rows.slice(1)}, null, 1);
const save = (name, type, content) => {
  const link = element('a', {download: name, href: URL.createObjectURL(content instanceof Blob ? content : new Blob([content], {type}))});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
};
// The figure as it stands, with its title and legend.
const pictureOf = figure => {
  const drawn = drawFigure(figure);
  const sources = drawn.chart ? [drawn.chart.canvas] : drawn.canvases ? drawn.canvases() : [];
  const ratio = window.devicePixelRatio || 1, pad = 14 * ratio, line = 24 * ratio;
  const perRow = Math.min(3, sources.length);
  const width = Math.max(...sources.map(c => c.width)), height = Math.max(...sources.map(c => c.height));
  const names = [...figure.node.querySelectorAll('.legend .key')].filter(key => key.getAttribute('aria-pressed') !== 'false');
  const picture = element('canvas');
  picture.width = perRow * width + 2 * pad;
  const captioned = drawn.canvases ? line : 0;
  picture.height = Math.ceil(sources.length / perRow) * (height + captioned) + 2 * pad + 1.6 * line + names.length * line;
  const ctx = picture.getContext('2d');
  ctx.fillStyle = palette.panel;
  ctx.fillRect(0, 0, picture.width, picture.height);
  ctx.fillStyle = palette.ink;
  ctx.textBaseline = 'middle';
  ctx.font = `600 ${15 * ratio}px ${Chart.defaults.font.family}`;
  ctx.fillText(figure.node.querySelector('.title').textContent, pad, pad + 0.5 * line);
  ctx.font = `${13 * ratio}px ${Chart.defaults.font.family}`;
  const shown = drawn.canvases ? [...figure.node.querySelectorAll('.panel:not([hidden]) .panel-name')] : [];
  sources.forEach((source, i) => {
    const left = pad + i % perRow * width, top = pad + 1.6 * line + Math.floor(i / perRow) * (height + captioned);
    if (captioned) ctx.fillText(shown[i].textContent, left, top + 0.5 * line);
    ctx.drawImage(source, left, top + captioned);
  });
  names.forEach((key, i) => {
    const y = picture.height - pad - (names.length - i - 0.5) * line;
    const stroke = key.querySelector('line'), dot = key.querySelector('circle'), box = key.querySelector('.box');
    if (stroke) {
      ctx.strokeStyle = stroke.getAttribute('stroke');
      ctx.lineWidth = 2.4 * ratio;
      ctx.setLineDash(stroke.getAttribute('stroke-dasharray').split(' ').filter(Boolean).map(v => v * ratio));
      ctx.beginPath(); ctx.moveTo(pad, y); ctx.lineTo(pad + 38 * ratio, y); ctx.stroke();
    }
    if (dot) { ctx.fillStyle = dot.getAttribute('fill'); ctx.beginPath(); ctx.arc(pad + 19 * ratio, y, 4 * ratio, 0, 7); ctx.fill(); }
    if (box) { ctx.fillStyle = box.style.background; ctx.fillRect(pad, y - 6 * ratio, 24 * ratio, 12 * ratio); }
    ctx.fillStyle = palette.ink;
    ctx.fillText(key.textContent, pad + 48 * ratio, y);
  });
  return picture;
};
for (const figure of figures) {
  const offers = element('div', {class: 'offers'});
  const offer = (kind, make) => {
    const button = element('button', {type: 'button', 'aria-label': `Save ${figure.block.id}.${kind}`}, kind.toUpperCase());
    button.addEventListener('click', make);
    offers.append(button);
  };
  offer('csv', () => save(figure.block.id + '.csv', 'text/csv', csvOf(drawFigure(figure).rows())));
  offer('json', () => save(figure.block.id + '.json', 'application/json', jsonOf(figure, drawFigure(figure).rows())));
  if (['plot', 'bars', 'frames', 'section'].includes(figure.block.type))
    offer('png', () => pictureOf(figure).toBlob(blob => save(figure.block.id + '.png', 'image/png', blob)));
  figure.node.querySelector('.heading').append(offers);
}
const whole = byId('save-all');
if (whole) whole.addEventListener('click', () => save(model.kind + '.json', 'application/json', JSON.stringify(model.data, null, 2)));

// ---- Light, dark and paper
const themeButton = byId('theme');
const nameTheme = () => { themeButton.textContent = {auto: 'Theme: as the system', light: 'Theme: light', dark: 'Theme: dark'}[theme]; };
themeButton.addEventListener('click', () => {
  theme = themes[(themes.indexOf(theme) + 1) % themes.length];
  remember('theme', theme === 'auto' ? null : theme);
  nameTheme();
  repaint(isDark());
});
nameTheme();
darkQuery.addEventListener('change', () => repaint(isDark()));
// On paper everything is drawn, in ink on white, as wide as the sheet, and fine enough to print.
const paperWidth = 640;
const onPaper = paper => {
  printing = paper;
  for (const node of document.querySelectorAll('details')) {
    if (paper) { node.dataset.was = node.open ? 'open' : ''; node.open = node.classList.contains('printed'); }
    else node.open = node.dataset.was === 'open';
  }
  if (paper) for (const figure of figures) drawFigure(figure);
  for (const chart of charts) {
    chart.options.devicePixelRatio = paper ? 3 : undefined;
    if (paper) chart.resize(paperWidth, chart.config.type === 'bar' ? chart.canvas.parentElement.clientHeight : 300); else chart.resize();
  }
  repaint(paper ? false : isDark());
};
window.addEventListener('beforeprint', () => onPaper(true));
window.addEventListener('afterprint', () => onPaper(false));

// ---- Near the window, a figure is drawn; a page of hundreds opens as fast as one of five.
root.dataset.figures = figures.length;
root.dataset.drawn = 0;
const watch = new IntersectionObserver(seen => {
  for (const {isIntersecting, target} of seen) {
    if (!isIntersecting) continue;
    watch.unobserve(target);
    drawFigure(figures.find(figure => figure.node === target));
  }
}, {rootMargin: '800px'});
for (const figure of figures) watch.observe(figure.node);
