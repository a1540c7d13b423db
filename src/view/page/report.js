// Sorting by the buttons of the head, and finding. Values are in data-value: numbers as numbers, the rest as texts; rows
// without a value stay at the end.
{
  const table = document.getElementById('inputs'), body = table.tBodies[0], rows = [...body.rows];
  const valueOf = (row, column) => row.cells[column].dataset.value;
  const compare = (a, b) => {
    const [x, y] = [Number(a), Number(b)];
    return Number.isNaN(x) || Number.isNaN(y) ? a.localeCompare(b, 'en', {numeric: true}) : x - y;
  };
  const heads = [...table.tHead.rows[0].cells];
  heads.forEach((head, column) => head.querySelector('button')?.addEventListener('click', () => {
    const sign = head.getAttribute('aria-sort') === 'ascending' ? -1 : 1;
    for (const other of heads) other.removeAttribute('aria-sort');
    head.setAttribute('aria-sort', sign > 0 ? 'ascending' : 'descending');
    const place = new Map(rows.map((row, k) => [row, k]));
    const sorted = [...rows].sort((a, b) => {
      const [x, y] = [valueOf(a, column), valueOf(b, column)];
      if (x === undefined || y === undefined) return (x === undefined) - (y === undefined) || place.get(a) - place.get(b);
      return sign * compare(x, y) || place.get(a) - place.get(b);
    });
    body.append(...sorted);
  }));
  const find = document.getElementById('find'), found = document.getElementById('found');
  find.addEventListener('input', () => {
    const word = find.value.toLowerCase();
    for (const row of rows) row.hidden = !row.textContent.toLowerCase().includes(word);
    found.textContent = word ? `${rows.filter((row) => !row.hidden).length} of ${rows.length}` : '';
  });
  document.querySelector('.tools').hidden = false;
}
