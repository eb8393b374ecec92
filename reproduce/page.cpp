// SPDX-License-Identifier: Apache-2.0
#include <reproduce/page.h>

#include <report/svg.h>

#include <fmt/format.h>

namespace raycontact::reproduce {

namespace {

using report::escape_html;

constexpr const char* style = R"css(
body{margin:0;background:#fbfaf8;color:#23262b;font:16px/1.55 system-ui,"DejaVu Sans",sans-serif}
main{max-width:1180px;margin:0 auto;padding:28px 16px 48px}
h1{font-size:28px;line-height:1.2;margin:0 0 10px}h2{font-size:20px;margin:44px 0 8px}h3{font-size:15px;margin:18px 0 6px}
.short{padding:10px 14px;background:#fff3d6;border:1px solid #e0b64c;border-radius:8px}
.plots{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,440px),1fr));gap:14px;margin:14px 0}
.plot{margin:0;padding:12px 14px 8px;background:#fff;border:1px solid #e4e1dc;border-radius:10px}
.plot figcaption{font-size:14px;display:flex;gap:4px 10px;flex-wrap:wrap;align-items:baseline}
.plot p,.soft,.unit,.key{color:#6a7079;font-size:13px}.plot p{margin:2px 0}
.key{white-space:nowrap}.key i{display:inline-block;width:14px;height:3px;margin-right:5px;vertical-align:middle}
svg{display:block;width:100%;height:auto}.tick,.label{fill:#6a7079;font-size:11.5px}
.grid{stroke:#e4e1dc}.axis,.notch{stroke:#6a7079}.line{fill:none;stroke-width:1.6;stroke-linejoin:round}
.wide{overflow-x:auto}table{border-collapse:collapse;background:#fff;border:1px solid #e4e1dc;font-size:14px;width:100%;min-width:min(900px,210vw)}
th,td{text-align:left;vertical-align:top;padding:5px 10px;border-bottom:1px solid #e4e1dc}
.passed,.reached{color:#00704f;font-weight:bold}.missed{color:#b03a00;font-weight:bold}.open{color:#6a7079;font-weight:bold}
.view{width:100%;height:min(80vh,720px);border:1px solid #e4e1dc;border-radius:10px}
button{font:inherit;padding:6px 16px;border:1px solid #6a7079;border-radius:8px;background:#fff;cursor:pointer}
@media(max-width:700px){.numbers,.numbers tbody,.numbers tr,.numbers td{display:block}.numbers{min-width:0}
.numbers tr{padding:8px 10px;border-bottom:1px solid #e4e1dc}.numbers tr:first-child{display:none}.numbers td{padding:0;border:0}
.numbers td:first-child{font-weight:bold;overflow-wrap:anywhere}.numbers td:nth-child(n+2):nth-child(-n+5){display:inline;margin-right:10px}
.numbers td:nth-child(2)::before{content:"paper "}.numbers td:nth-child(3)::before{content:"ours "}.numbers td:last-child{color:#6a7079}}
)css";

// A view is unpacked when it is asked for: until then it costs the reader nothing.
constexpr const char* script = R"js(
for (const button of document.querySelectorAll('button[data-view]')) button.onclick = async () => {
  const packed = Uint8Array.from(atob(document.getElementById(button.dataset.view).textContent), c => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  const frame = document.createElement('iframe');
  frame.className = 'view'; frame.title = '3D view';
  frame.srcdoc = await new Response(stream).text();
  button.replaceWith(frame);
};
)js";

std::string row(const char* cell, const std::vector<std::string>& cells) {
    std::string html = "<tr>";
    for (const std::string& text : cells) html += fmt::format("<{0}>{1}</{0}>", cell, escape_html(text));
    return html + "</tr>\n";
}

std::string table(const Table& t) {
    std::string html = "<h3>" + escape_html(t.title) + "</h3>\n<div class=\"wide\"><table>" + row("th", t.head);
    for (const auto& cells : t.rows) html += row("td", cells);
    return html + "</table></div>\n";
}

std::string verdicts(const std::vector<Number>& numbers) {
    std::string html =
        "<div class=\"wide\"><table class=\"numbers\">"
        + row("th", {"number", "paper", "ours", "unit", "verdict", "how ours was measured, and what differs"});
    for (const Number& n : numbers) {
        const std::string word(to_string(n.verdict));
        html +=
            fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td class=\"{}\">{}</td><td>{}</td></tr>\n",
                        escape_html(n.id), report::readable(n.paper), report::readable(n.ours), escape_html(n.unit),
                        n.verdict == Verdict::not_comparable ? "open" : word, word, escape_html(n.why));
    }
    return html + "</table></div>\n";
}

std::string paragraph(const std::string& text, const char* look = "") {
    return fmt::format("<p class=\"{}\">{}</p>\n", look, escape_html(text));
}

std::string section(const Section& s) {
    std::string html = fmt::format("<h2 id=\"{}\">{}</h2>\n", escape_html(s.name), escape_html(s.title));
    for (const std::string& text : s.outcome.paragraphs) html += paragraph(text);
    if (!s.outcome.numbers.empty()) html += verdicts(s.outcome.numbers);
    for (const PackedView& view : s.outcome.views)
        html += fmt::format("<p><button data-view=\"{0}\">Open the 3D view</button> <span class=\"soft\">orbit, play, "
                            "rays, contacts, predictions; {1:.1f} MB, already in this page; needs scripts and WebGL 2"
                            "</span></p>\n<script type=\"text/plain\" id=\"{0}\">{2}</script>\n",
                            escape_html(view.name), double(view.html.size()) / 1e6, view.html);
    html += "<div class=\"plots\">\n";
    for (const report::Plot& plot : s.outcome.plots) html += report::plot_figure(plot);
    html += "</div>\n";
    for (const Table& t : s.outcome.tables) html += table(t);
    for (const std::string& machine : s.machines) html += paragraph("Measured: " + machine, "soft");
    return html;
}

} // namespace

std::string make_page(const Page& page) {
    const std::string title = page.plan.is_full() ? "The paper, reproduced" : "The paper, reproduced: short version";
    std::string html = "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
                       "content=\"width=device-width,initial-scale=1\"><link rel=\"icon\" href=\"data:,\"><title>"
                       + title + "</title><style>" + style + report::colour_style()
                       + "</style></head>\n<body><main>\n<h1>" + title + "</h1>\n";
    html += paragraph("Lehericey, Gouranton, Arnaldi: Ray-Traced Collision Detection: Interpenetration Control and "
                      "Multi-GPU Performance (2013). Each number that the paper states stands beside ours. passed: "
                      "better than the paper; reached: within 5 % of its figure; missed: worse. \"not comparable\" "
                      "says that the paper leaves undefined what it measured, or that this machine lacks the devices.");
    if (!page.plan.is_full()) html += paragraph(page.plan.warning(), "short");
    if (!page.not_run.empty()) {
        std::string names;
        for (const std::string& name : page.not_run) names += (names.empty() ? "" : ", ") + name;
        html += paragraph("Not run yet: " + names + ". `raycontact reproduce all` with the same folder adds them.",
                          "short");
    }
    std::vector<Number> all;
    for (const Section& s : page.sections) all.insert(all.end(), s.outcome.numbers.begin(), s.outcome.numbers.end());
    html += "<h2>All numbers</h2>\n" + verdicts(all);
    html +=
        "<h2>What the paper leaves open</h2>\n"
        + paragraph(
            "Its constants have no values; of ours the displacement threshold was chosen by the figures of section "
            "5.2, confidence and distanceExtension are the least that section 3.1 allows. Its meshes are not "
            "available; ours are stand-ins of the same size. The percentages of its Table 2 (59 and 42; the abstract "
            "says 52) do not follow from its lengths, which give 33.0 and 41.9. Section 3.1 cuts predictive rays at "
            "distanceExtension, section 5.3 at cullingDist. Its times were measured on a GTX 660 and two GTX 580.");
    for (const Section& s : page.sections) html += section(s);
    return html + "</main><script>" + script + "</script></body></html>\n";
}

} // namespace raycontact::reproduce
