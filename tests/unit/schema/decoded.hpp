/// Bytes along an IDL text, for tests that write both out.
#pragma once

#include <sstream>
#include <string>
#include <vector>

#include "schema/error.hpp"
#include "schema/idl_parser.hpp"
#include "schema/message_reader.hpp"

namespace baton::test {

struct ValueText {
  std::ostream& out;
  void operator()(bool value) const { out << (value ? "true" : "false"); }
  void operator()(schema::Bytes value) const { out << value.size() << " octets"; }
  template <class Value>
  void operator()(const Value& value) const {
    out << value;
  }
};

/// Of a message of type S with this body, octet by octet, in plain CDR of little endian: "a=1 b[0]=2"; a struct without
/// members as "{}". What is wrong, when there is no such type or the bytes are no such message.
inline std::string decoded(const std::string& idl, const std::vector<int>& body) {
  std::vector<std::byte> bytes{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
  for (const int one : body) bytes.push_back(static_cast<std::byte>(one));
  std::ostringstream out;
  try {
    const schema::TypeSet types = schema::parseIdl(idl);
    const schema::Type* type = types.find("S");
    if (type == nullptr) {
      const schema::Problem* problem = types.problemOf("S");
      return problem == nullptr ? "no type S" : problem->definition + ": " + problem->text;
    }
    schema::MessageReader reader(*type, bytes);
    for (schema::Item item; reader.next(item);) {
      if (item.what == schema::Item::What::kEnd) continue;
      const bool is_empty = item.type->kind == schema::Kind::kStruct && item.type->members.empty();
      if (item.what == schema::Item::What::kBegin && !is_empty) continue;
      if (out.tellp() > 0) out << ' ';
      if (is_empty) {
        out << "{}";
        continue;
      }
      out << reader.path() << '=';
      std::visit(ValueText{out}, item.value);
    }
  } catch (const UsageError& error) {
    return error.what();
  }
  return out.str();
}

}  // namespace baton::test
