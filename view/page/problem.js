// A page that cannot be shown says why.
const framed = window.parent !== window; // in a report: the wheel is the report's until someone clicks here
const element = id => document.getElementById(id);
const counted = (count, one, many) => `${count} ${count === 1 ? one : many}`;
const median = values => [...values].sort((a, b) => a - b)[values.length >> 1];

function fail(error) {
  element('problem').textContent = error && error.message ? error.message : String(error);
  element('problem').hidden = false;
  document.documentElement.dataset.state = 'failed';
  console.error(error);
}
