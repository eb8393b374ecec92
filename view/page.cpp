// SPDX-License-Identifier: Apache-2.0
#include <view/page.h>

#include "page_text.h"

#include <stdexcept>

namespace raycontact::view {

namespace {

std::string_view file(std::string_view name) {
    for (const PageFile& page_file : page_files)
        if (page_file.name == name) return page_file.text;
    throw std::logic_error("view/page has no file " + std::string(name));
}

std::string for_html(std::string_view text) {
    std::string safe;
    for (const char c : text) {
        if (c == '<')
            safe += "&lt;";
        else if (c == '&')
            safe += "&amp;";
        else
            safe += c;
    }
    return safe;
}

// Within a script element no "<" may stand: "<!--" and "</script" would change how the rest is read.
std::string for_script(std::string_view json) {
    std::string safe;
    for (const char c : json) {
        if (c == '<')
            safe += "\\u003c";
        else
            safe += c;
    }
    return safe;
}

} // namespace

std::string make_page(std::string_view title, std::string_view json) {
    std::string page = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                       "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>"
                       + for_html(title) + "</title>\n<style>\n";
    page += file("view.css");
    page += "</style>\n</head>\n<body>\n";
    page += file("view.html");
    page += "<script type=\"application/json\" id=\"recording\">" + for_script(json) + "</script>\n<script>\n";
    page += "'use strict';\n";
    page += file("problem.js");
    page += "(async()=>{\n";
    for (const char* part :
         {"decode.js", "matrix.js", "camera.js", "shaders.js", "bodies.js", "layers.js", "controls.js", "main.js"})
        page += file(part);
    page += "})().catch(fail);\n</script>\n</body>\n</html>\n";
    return page;
}

} // namespace raycontact::view
