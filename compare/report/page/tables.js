// Tables that sort, and maps of verdicts.
const drawTable = (block, body) => {
  const empty = value => value === null || value === undefined || value === '';
  const used = block.columns.map((_, i) => i).filter(i => i === 0 || block.rows.some(row => !empty(row.cells[i])));
  const node = element('table');
  const rowsBody = element('tbody');
  let chosen = '', sorted = null;
  const choices = [...new Set(block.rows.map(row => row.choice))];
  const order = (a, b, i) => {
    const left = a.cells[i], right = b.cells[i];
    if (empty(left) !== empty(right)) return empty(left) ? 1 : -1;  // what is missing comes last, whichever the order
    if (empty(left)) return 0;
    const way = sorted.down ? -1 : 1;
    if (isNumber(left) && isNumber(right)) return way * (left - right);
    return way * String(left).localeCompare(String(right), 'en', {numeric: true});
  };
  const cellOf = (row, i) => {
    const value = row.cells[i], column = block.columns[i];
    const text = isNumber(value) ? formatted(value, column.format) : empty(value) ? '\u2013' : String(value);
    const cell = i === 0 ? element('th', {scope: 'row'}, text) : element('td', column.text ? {class: 'text'} : {}, text);
    if (i === 0) {
      const badges = [...(row.entry >= 0 ? badgesOf(entries[row.entry]) : []), ...(row.badge ? [element('span', {class: 'badge'}, row.badge)] : [])];
      for (const badge of badges) cell.append(' ', badge);
    }
    return cell;
  };
  const fill = () => {
    const rows = block.rows.filter(row => row.choice === chosen);
    if (sorted) rows.sort((a, b) => order(a, b, sorted.column));
    rowsBody.replaceChildren(...rows.map(row => element('tr', {}, ...used.map(i => cellOf(row, i)))));
  };
  const head = element('tr');
  for (const i of used) {
    const column = block.columns[i];
    const button = element('button', {type: 'button', title: 'Sort'}, column.name);
    if (column.unit) button.append(' ', element('span', {class: 'unit'}, `(${column.unit})`));
    const cell = element('th', {scope: 'col', ...(column.text || i === 0 ? {class: 'text'} : {})}, button);
    button.addEventListener('click', () => {
      sorted = {column: i, down: cell.getAttribute('aria-sort') === 'ascending'};
      for (const other of head.children) other.removeAttribute('aria-sort');
      cell.setAttribute('aria-sort', sorted.down ? 'descending' : 'ascending');
      fill();
    });
    head.append(cell);
  }
  if (block.choice) {
    const select = element('select', {'aria-label': block.choice});
    for (const choice of choices) select.append(element('option', {}, choice));
    chosen = choices[choices.length - 1];
    select.value = chosen;
    select.addEventListener('change', () => { chosen = select.value; fill(); });
    body.append(element('div', {class: 'controls'}, element('label', {}, block.choice, ' ', select)));
  }
  node.append(element('thead', {}, head), rowsBody);
  body.append(element('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': block.title}, node));
  fill();
  return {rows: () => [[...(block.choice ? [block.choice] : []), ...block.columns.map(column => column.key || axisName(column)), 'warning'],
    ...block.rows.map(row => [...(block.choice ? [row.choice] : []), ...row.cells.map(value => value ?? ''),
      [row.entry >= 0 ? warningOf(entries[row.entry]) : '', row.badge].filter(Boolean).join(', ')])]};
};

const verdictWords = {sound: 'sound', refused: 'refused beforehand', stopped: 'stopped with its reason', warning: 'with a warning', wrong: 'wrong'};
const verdictMarks = {sound: '\u2713', refused: '\u2205', stopped: '\u25a0', warning: '!', wrong: '\u2717'};
const drawMap = (block, body) => {
  const node = element('table', {class: 'map'});
  node.append(element('thead', {}, element('tr', {}, element('th', {scope: 'col', class: 'text'}, `${block.row_name} \u2193  ${block.column_name} \u2192`),
    ...block.columns.map(name => element('th', {scope: 'col'}, name)))));
  const rows = element('tbody');
  block.rows.forEach((name, r) => rows.append(element('tr', {}, element('th', {scope: 'row'}, name), ...block.columns.map((_, c) => {
    const cell = block.cells.find(other => other.row === r && other.column === c);
    if (!cell) return element('td', {class: 'verdict'}, '');
    const text = `${verdictMarks[cell.verdict]} ${cell.text}`.trim();
    return element('td', {class: 'verdict ' + cell.verdict, tabindex: '0', title: [verdictWords[cell.verdict], cell.hover].filter(Boolean).join(': ')}, text);
  }))));
  node.append(rows);
  const used = Object.keys(verdictWords).filter(verdict => block.cells.some(cell => cell.verdict === verdict));
  const key = element('ul', {class: 'legend'}, ...used.map(verdict => element('li', {}, element('span', {class: 'key'}, element('span', {class: 'verdict ' + verdict}, verdictMarks[verdict]), verdictWords[verdict]))));
  const said = element('p', {class: 'small', 'aria-live': 'polite'});
  node.addEventListener('focusin', event => { said.textContent = event.target.title || ''; });
  node.addEventListener('mouseover', event => { said.textContent = event.target.title || ''; });
  body.append(element('div', {class: 'scroll', tabindex: '0', role: 'region', 'aria-label': block.title}, node), key, said);
  return {rows: () => [[block.row_name, block.column_name, 'verdict', 'text', 'reason'],
    ...block.cells.map(cell => [block.rows[cell.row], block.columns[cell.column], verdictWords[cell.verdict], cell.text, cell.hover])]};
};
