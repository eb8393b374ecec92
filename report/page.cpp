// SPDX-License-Identifier: Apache-2.0
#include <report/page.h>

#include <report/svg.h>

#include <fmt/format.h>

namespace raycontact::report {
namespace {

constexpr const char* style = R"css(
:root{color-scheme:light dark;--paper:#fbfaf8;--card:#fff;--ink:#23262b;--soft:#6a7079;--rule:#e4e1dc;--c0:#2f6fb0;--c1:#d9662f;--mark:#efece6}
@media(prefers-color-scheme:dark){:root{--paper:#15171a;--card:#1d2024;--ink:#e8e6e1;--soft:#9aa1ab;--rule:#33373d;--c0:#6fb1ee;--c1:#f29765;--mark:#2a2e34}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,-apple-system,"Segoe UI",Roboto,"DejaVu Sans",sans-serif}
main{max-width:1180px;margin:0 auto;padding:36px 24px 48px}
h1{font-size:30px;line-height:1.2;margin:0 0 10px;letter-spacing:-.01em}
h2{font-size:19px;margin:38px 0 12px}
.lead{max-width:110ch;margin:18px 0 0;color:var(--ink)}
.view{margin:0}.view iframe{display:block;width:100%;height:min(78vh,760px);border:1px solid var(--rule);border-radius:10px}
.view figcaption,.soft{color:var(--soft);font-size:14px}
@media print{.view{display:none}}
.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,440px),1fr));gap:14px}
.plot{margin:0;padding:12px 14px 8px;background:var(--card);border:1px solid var(--rule);border-radius:10px}
.plot figcaption{font-size:14px;display:flex;gap:10px;flex-wrap:wrap;align-items:baseline;min-height:1.6em}
.plot .unit{color:var(--soft)}
.plot output{margin-left:auto;font-variant-numeric:tabular-nums;color:var(--soft);font-size:13px}
.plot p{margin:2px 0 2px;color:var(--soft);font-size:13px;line-height:1.45}
.key{color:var(--soft);font-size:13px;white-space:nowrap}.key i{display:inline-block;width:14px;height:3px;border-radius:2px;margin-right:5px;vertical-align:middle}
i.s0{background:var(--c0)}i.s1{background:var(--c1)}
svg{display:block;width:100%;height:auto;touch-action:pan-y}
.grid{stroke:var(--rule)}.axis,.notch{stroke:var(--soft)}
.tick,.label{fill:var(--soft);font-size:11.5px;font-variant-numeric:tabular-nums}
.line{fill:none;stroke-width:1.6;stroke-linejoin:round}.s0{stroke:var(--c0)}.s1{stroke:var(--c1)}
.cursor line{stroke:var(--soft);stroke-dasharray:3 3}.cursor circle{fill:var(--card);stroke-width:2}
.wide{overflow-x:auto}
table{border-collapse:collapse;width:100%;background:var(--card);border:1px solid var(--rule);border-radius:10px;overflow:hidden;font-size:15px}
td,th{padding:7px 14px;text-align:left;border-top:1px solid var(--rule);vertical-align:top}
thead th{border-top:0;font-size:13px;color:var(--soft);font-weight:500}
td.value{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap;font-weight:600;overflow-wrap:anywhere}
td.meaning{color:var(--soft)}
@media(max-width:560px){main{padding:20px 12px 32px}td,th{padding:6px 8px}td.meaning,th:nth-child(4){display:none}td.value{white-space:normal}}
pre{background:var(--mark);padding:13px 16px;border-radius:10px;overflow-x:auto;font:14px/1.5 ui-monospace,"DejaVu Sans Mono",monospace;margin:0}
footer{margin-top:34px;color:var(--soft);font-size:13.5px}
)css";

constexpr const char* script = R"js(
const data=JSON.parse(document.getElementById('data').textContent);
function read(v){if(v===null||!isFinite(v))return '-';const a=Math.abs(v);
  return a>=1000?Math.round(v).toLocaleString('fr').replace(/\s/g,'\u202f'):String(+v.toPrecision(4))}
const charts=[...document.querySelectorAll('.plot')].map((figure,k)=>{
  const svg=figure.querySelector('svg'),box=n=>+svg.dataset[n];
  return{figure,svg,plot:data.plots[k],left:box('left'),right:box('right'),top:box('top'),bottom:box('bottom'),
    height:svg.viewBox.baseVal.height,width:svg.viewBox.baseVal.width}});
const steps=data.steps,first=steps[0],last=steps[steps.length-1];
function point(n){charts.forEach(c=>{
  const x=c.left+(c.right-c.left)*(last>first?(steps[n]-first)/(last-first):.5),low=c.height-c.bottom;
  let marks=`<line x1="${x}" x2="${x}" y1="${c.top}" y2="${low}"/>`;
  c.plot.series.forEach((s,i)=>{const v=s.values[n];if(v===null)return;
    marks+=`<circle class="s${i}" r="3.5" cx="${x}" cy="${low-(low-c.top)*Math.min(v/c.plot.top,1)}"/>`});
  c.svg.querySelector('.cursor').innerHTML=marks;
  c.figure.querySelector('output').textContent='step '+steps[n]+': '+
    c.plot.series.map(s=>read(s.values[n])).join(' / ')+' '+c.plot.unit})}
function leave(){charts.forEach(c=>{c.svg.querySelector('.cursor').innerHTML='';c.figure.querySelector('output').textContent=''})}
charts.forEach(c=>{c.svg.onpointermove=e=>{const r=c.svg.getBoundingClientRect();
    const x=(e.clientX-r.left)/r.width*c.width,t=Math.min(Math.max((x-c.left)/(c.right-c.left),0),1);
    point(Math.round(t*(steps.length-1)))};
  c.svg.onpointerleave=leave});
)js";

std::string table(const std::vector<Row>& rows) {
    std::string html =
        "<div class=\"wide\"><table><thead><tr><th>figure</th><th style=\"text-align:right\">value</th><th>unit</th>"
        "<th>what it is</th></tr></thead><tbody>\n";
    for (const Row& row : rows)
        html +=
            fmt::format("<tr><td>{}</td><td class=\"value\">{}</td><td>{}</td><td class=\"meaning\">{}</td></tr>\n",
                        escape_html(row.name), escape_html(row.value), escape_html(row.unit), escape_html(row.meaning));
    return html + "</tbody></table></div>\n";
}

} // namespace

std::string make_page(const Page& page) {
    std::string html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
                       "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">";
    html += "<link rel=\"icon\" href=\"data:,\"><title>" + escape_html(page.title) + "</title><style>" + style
            + "</style></head>\n<body><main>\n";
    html += "<h1>" + escape_html(page.title) + "</h1>\n";
    if (!page.view.empty())
        html += "<figure class=\"view\"><iframe title=\"The run in 3D\" srcdoc=\"" + escape_html(page.view)
                + "\"></iframe><figcaption>Drag to look around, with shift to move. After a click the wheel zooms and "
                  "the space bar plays.</figcaption></figure>\n";
    html += "<p class=\"lead\">" + escape_html(page.summary) + "</p>\n";
    html += "<h2>Step by step</h2>\n<div class=\"plots\">\n";
    for (const Plot& plot : page.plots) html += plot_figure(plot);
    html += "</div>\n<h2>Figures of the whole run</h2>\n" + table(page.rows);
    if (!page.zeros.empty()) html += "<p class=\"soft\">" + escape_html(page.zeros) + "</p>\n";
    if (!page.comparison.rows.empty())
        html += "<h2>" + escape_html(page.comparison.title) + "</h2>\n" + table(page.comparison.rows)
                + "<p class=\"soft\">" + escape_html(page.comparison.note) + "</p>\n";
    html += "<h2>The same run again</h2>\n<pre>" + escape_html(page.command) + "</pre>\n";
    html += "<footer>" + escape_html(page.footer) + "</footer>\n</main>\n";
    html += "<script type=\"application/json\" id=\"data\">" + plot_data(page.plots) + "</script>\n<script>" + script
            + "</script>\n</body></html>\n";
    return html;
}

} // namespace raycontact::report
