// A page that cannot be shown says why.
const element = id => document.getElementById(id);

function fail(error) {
  element('problem').textContent = error && error.message ? error.message : String(error);
  element('problem').hidden = false;
  document.documentElement.dataset.state = 'failed';
  console.error(error);
}
