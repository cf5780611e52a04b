#pragma once

#include <string_view>

/// The page's parts, embedded at build time from the files beside this one.
namespace flowrest::compare::sources {

std::string_view page_html();
std::string_view page_css();
std::string_view page_js();

}  // namespace flowrest::compare::sources
