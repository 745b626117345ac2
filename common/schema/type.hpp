/// Types as a recording's own text declares them. Typedefs and constants are resolved: what is left is what decides how
/// a payload is read, and what people want to see of it (names, units).
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace baton::schema {

enum class Kind : std::uint8_t {
  kBoolean,
  kOctet,
  kChar,
  kWideChar,
  kInt8,
  kUint8,
  kInt16,
  kUint16,
  kInt32,
  kUint32,
  kInt64,
  kUint64,
  kFloat,
  kDouble,
  kString,
  kEnum,
  kStruct,
  kUnion,
  kSequence,
  kArray
};

struct Type;

struct Member {
  std::string name{};
  const Type* type = nullptr;
  std::string unit{};  // of @unit("m"); empty for none
  bool is_key = false;
};

/// Value of a union's discriminator that chooses one of its members.
struct Label {
  std::int64_t value = 0;
  std::size_t member = 0;  // index in Type::members
};

/// The name of a union's first member, its discriminator; no name in IDL can be this.
inline constexpr std::string_view kDiscriminator = "$discriminator";

/// A union has at least one member, an array at least one element: a value takes a byte or more, but for structs
/// without members and what is made of those alone.
struct Type {
  Kind kind = Kind::kBoolean;
  std::string name{};              // of a struct, union or enum, with its modules: "baton::msg::PlantState"
  std::vector<Member> members{};   // struct: in their order; union: the discriminator, then the cases
  std::vector<Label> labels{};     // union
  std::size_t default_member = 0;  // union: chosen by all other values; 0 for none
  std::map<std::int64_t, std::string> enumerators{};  // enum: by value
  const Type* element = nullptr;  // sequence and array; an array of arrays has the first index outside
  std::uint64_t bound = 0;        // array: elements; string and sequence: at most so many, 0 for no bound
  unsigned depth = 0;             // of types within it, as far as they were defined before it
  std::uint64_t least_bytes = 0;  // no value takes fewer in a payload
};

/// The name of an enumerator; empty when no enumerator has the value.
[[nodiscard]] std::string_view enumeratorName(const Type& type, std::int64_t value);

/// The member a union has for a discriminator; null when it has none.
[[nodiscard]] const Member* chosenMember(const Type& type, std::int64_t discriminator);

/// A definition of a text that no type could be made of.
struct Problem {
  std::string definition;  // its name with its modules; empty where the text gives none
  std::string text;        // "line 3: expected ..., found ..."
};

/// All types of one text.
class TypeSet {
 public:
  TypeSet() = default;
  TypeSet(TypeSet&&) = default;
  TypeSet& operator=(TypeSet&&) = default;

  /// A struct, union, enum or typedef by its full name; null when there is none. Valid as long as the set.
  [[nodiscard]] const Type* find(std::string_view name) const;
  [[nodiscard]] const std::map<std::string, const Type*, std::less<>>& names() const { return names_; }

  /// Why there is no type of that name: what is wrong with its definition, with one that it uses, or with what is
  /// around it. Null when the text has no such definition.
  [[nodiscard]] const Problem* problemOf(std::string_view name) const;
  /// In the order of the text.
  [[nodiscard]] const std::vector<Problem>& problems() const { return problems_; }

 private:
  friend class IdlParser;
  std::deque<Type> types_;  // stay where they are
  std::map<std::string, const Type*, std::less<>> names_;
  std::vector<Problem> problems_;
  std::map<std::string, std::size_t, std::less<>> unusable_;  // names; index of the problem they have
};

}  // namespace baton::schema
