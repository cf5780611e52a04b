#pragma once

#include <string_view>

/// The page's parts, embedded at build time from the files in page/.
namespace flowrest::report::sources {

std::string_view page_html();
std::string_view page_css();
std::string_view base_js();
std::string_view plots_js();
std::string_view sections_js();
std::string_view tables_js();
std::string_view page_js();

}  // namespace flowrest::report::sources
