#include "bag/csv_columns.hpp"

#include <algorithm>

#include "bag/message_text.hpp"
#include "base/error.hpp"

namespace baton {
namespace {

bool isList(const schema::Type& type) {
  return type.kind == schema::Kind::kSequence || type.kind == schema::Kind::kArray;
}

/// Which of its parent's children an item is: a union has read only the member it chose.
std::size_t childOf(const schema::Type& parent, const schema::Item& item) {
  return item.member == nullptr ? item.index : static_cast<std::size_t>(item.member - parent.members.data());
}

}  // namespace

std::string csvField(const std::string& text) {
  if (text.find_first_of("\",\r\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

CsvColumns::CsvColumns(const schema::Type& type) : root_(placeOf(type, "")) {}

/// Recursion: as deep as types are.
CsvColumns::Place CsvColumns::placeOf(const schema::Type& type, const std::string& unit) {
  if (++places_ > kMax)
    throw UsageError("a table of more than " + std::to_string(kMax) + " columns: export it as --json");
  Place place{.type = &type, .unit = unit};
  for (const schema::Member& member : type.members) {
    place.children.push_back(placeOf(*member.type, member.unit.empty() ? unit : member.unit));
  }
  return place;
}

void CsvColumns::fit(schema::Bytes payload) {
  schema::MessageReader reader(*root_.type, payload);
  std::vector<Place*> around;
  for (schema::Item item; reader.next(item);) {
    if (item.what == schema::Item::What::kEnd) {
      around.pop_back();
      continue;
    }
    Place* place = &root_;
    if (!around.empty()) {
      Place& parent = *around.back();
      const std::size_t child = childOf(*parent.type, item);
      if (child == parent.children.size()) parent.children.push_back(placeOf(*item.type, parent.unit));
      place = &parent.children[child];
    }
    if (item.what == schema::Item::What::kBegin) around.push_back(place);
  }
}

std::vector<std::string> CsvColumns::finish() {
  std::vector<std::string> names;
  name(root_, "", names);
  columns_ = names.size();
  return names;
}

void CsvColumns::name(Place& place, const std::string& path, std::vector<std::string>& names) {
  const bool is_list = isList(*place.type);
  const bool is_struct = place.type->kind == schema::Kind::kStruct;  // of no members, too
  const bool is_bytes = is_list && place.type->element->kind == schema::Kind::kOctet;
  const bool is_value = is_bytes || (!is_list && !is_struct && place.type->members.empty());
  if (is_value) {
    place.column = names.size();
    names.push_back(path + (place.unit.empty() ? "" : " [" + place.unit + "]"));
  }
  for (std::size_t i = 0; i < place.children.size(); ++i) {
    const std::string own =
        is_list ? "[" + std::to_string(i) + "]" : (path.empty() ? "" : ".") + place.type->members[i].name;
    name(place.children[i], path + own, names);
  }
}

void CsvColumns::fill(schema::Bytes payload, std::vector<std::string>& cells) const {
  cells.assign(columns_, "");
  schema::MessageReader reader(*root_.type, payload);
  std::vector<const Place*> around;
  for (schema::Item item; reader.next(item);) {
    if (item.what == schema::Item::What::kEnd) {
      around.pop_back();
      continue;
    }
    const Place* place = around.empty() ? &root_ : &around.back()->children.at(childOf(*around.back()->type, item));
    if (item.what == schema::Item::What::kBegin) {
      around.push_back(place);
    } else {
      cells.at(place->column) = plainText(*item.type, item.value, true);
    }
  }
}

}  // namespace baton
