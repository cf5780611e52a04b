#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "compare/report/page.h"

/// What the page's script draws its figures from.
namespace flowrest::report {

/// The figures of a page, in the order in which they stand, and the entries they refer to.
nlohmann::ordered_json page_json(const Page&, const std::vector<const Block*>& figures);

/// The id of a figure or table; empty for words.
std::string id_of(const Block&);
/// Its title and caption.
std::string title_of(const Block&);
std::string caption_of(const Block&);

/// @throws std::logic_error where lists of one figure differ in length or name an entry that is not there.
void check(const Block&, std::size_t entries);

}  // namespace flowrest::report
