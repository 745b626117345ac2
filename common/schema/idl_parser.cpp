#include "schema/idl_parser.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <string>
#include <utility>

#include "schema/idl_annotations.hpp"
#include "schema/idl_lexer.hpp"
#include "schema/idl_names.hpp"
#include "schema/idl_preprocessor.hpp"
#include "schema/idl_skip.hpp"
#include "schema/idl_values.hpp"
#include "schema/limits.hpp"
#include "schema/type_users.hpp"

namespace baton::schema {
namespace {

struct Primitive {
  std::string_view words;
  Kind kind;
  std::uint64_t bytes;
};
constexpr std::array kPrimitives{
    Primitive{"boolean", Kind::kBoolean, 1}, Primitive{"octet", Kind::kOctet, 1},
    Primitive{"char", Kind::kChar, 1},       Primitive{"wchar", Kind::kWideChar, 2},
    Primitive{"int8", Kind::kInt8, 1},       Primitive{"uint8", Kind::kUint8, 1},
    Primitive{"int16", Kind::kInt16, 2},     Primitive{"short", Kind::kInt16, 2},
    Primitive{"uint16", Kind::kUint16, 2},   Primitive{"unsigned short", Kind::kUint16, 2},
    Primitive{"int32", Kind::kInt32, 4},     Primitive{"long", Kind::kInt32, 4},
    Primitive{"uint32", Kind::kUint32, 4},   Primitive{"unsigned long", Kind::kUint32, 4},
    Primitive{"int64", Kind::kInt64, 8},     Primitive{"long long", Kind::kInt64, 8},
    Primitive{"uint64", Kind::kUint64, 8},   Primitive{"unsigned long long", Kind::kUint64, 8},
    Primitive{"float", Kind::kFloat, 4},     Primitive{"double", Kind::kDouble, 8},
    Primitive{"string", Kind::kString, 4},
};

constexpr std::array<std::string_view, 4> kUnsupported{"wstring", "fixed", "map", "any"};
// An enum with fewer bits takes one byte or two in the payloads of some vendors and four in those of others.
constexpr std::int64_t kMostBitsOfShortEnum = 16, kBitsOfEnum = 32;
constexpr std::int64_t kBitsOfBitmask = 32;

constexpr std::int64_t kMostElements = std::numeric_limits<std::uint32_t>::max();  // of an array, sequence or string

/// What a union can be switched on.
bool isDiscriminator(Kind kind) {
  return kind == Kind::kEnum || kind == Kind::kBoolean || kind == Kind::kOctet || isInteger(kind) ||
         kind == Kind::kChar || kind == Kind::kWideChar;
}

}  // namespace

class IdlParser {
 public:
  explicit IdlParser(std::string_view text) : lexer_(text) {
    for (const Primitive& one : kPrimitives) {
      primitives_[one.words] = &set_.types_.emplace_back(Type{.kind = one.kind, .least_bytes = one.bytes});
    }
  }

  TypeSet parse() {
    while (!atEnd()) definition(0);
    if (!open_.empty()) dropUndefined();
    return std::move(set_);
  }

 private:
  Type* add(Type type) {
    if (set_.types_.size() >= kMaxDefinitions) lexer_.failBeyond(kMaxDefinitions, "types");
    return &set_.types_.emplace_back(checked(std::move(type)));
  }
  Type checked(Type type) const {
    if (type.depth > kMaxDepth) lexer_.failBeyond(kMaxDepth, "types within each other");
    if (type.least_bytes > kMaxLeastBytes) lexer_.failBeyond(kMaxLeastBytes, "bytes for a value");
    return type;
  }

  /// Of a sequence or a string.
  std::uint64_t bound() { return static_cast<std::uint64_t>(values_.integerBeforeAngle(1, kMostElements)); }

  // --- types by name

  /// Whether the text itself has declared the word that comes next, though IDL knows it too: int8, map.
  bool isOwnName(const std::string& word) {
    IdlLexer ahead = lexer_;
    ahead.advance();
    return !isKeyword(word) && (ahead.is("::") || names_.hasType(word));
  }

  const Type* typeName() {
    if (lexer_.accept("sequence")) return sequence();
    const bool is_word = lexer_.token().kind == Token::Kind::kWord;
    std::string words(is_word ? lexer_.token().text : "");
    const bool is_unsupported = std::ranges::count(kUnsupported, words) > 0;
    const bool is_primitive = words == "unsigned" || std::ranges::count(kPrimitives, words, &Primitive::words) > 0;
    if ((!is_unsupported && !is_primitive) || isOwnName(words)) return names_.type();
    if (is_unsupported) lexer_.fail("a type that all encode alike", "'" + words + "', which is not supported");
    lexer_.advance();
    if (words == "unsigned") {
      if (!lexer_.is("short") && !lexer_.is("long")) lexer_.fail("'short' or 'long'");
      words += " " + std::string(lexer_.token().text);
      lexer_.advance();
    }
    if (words.ends_with("long") && lexer_.accept("long")) words += " long";
    if (words == "long" && lexer_.is("double")) lexer_.fail("a number that all encode alike", "'long double'");
    const Type* type = primitives_.at(words);
    if (type->kind != Kind::kString || !lexer_.accept("<")) return type;
    Type bounded = *type;
    bounded.bound = bound();
    lexer_.expect(">");
    return add(std::move(bounded));
  }

  const Type* sequence() {
    // Recursion: as deep as sequences are nested in the text.
    if (++nesting_ > kMaxDepth) lexer_.failBeyond(kMaxDepth, "types within each other");
    lexer_.expect("<");
    const Type* element = typeName();
    const std::uint64_t most = lexer_.accept(",") ? bound() : 0;
    lexer_.expect(">");
    --nesting_;
    return add(
        {.kind = Kind::kSequence, .element = element, .bound = most, .depth = element->depth + 1, .least_bytes = 4});
  }

  /// A name and the sizes of an array behind it, if there are any.
  std::pair<std::string, const Type*> declarator(const Type* type) {
    expectDefined(*type);
    std::string name = lexer_.name("a name");
    std::vector<std::uint64_t> sizes;
    while (lexer_.accept("[")) {
      if (sizes.size() == kMaxDepth) lexer_.failBeyond(kMaxDepth, "dimensions");
      sizes.push_back(static_cast<std::uint64_t>(values_.integer(1, kMostElements)));
      lexer_.expect("]");
    }
    std::ranges::reverse(sizes);  // the last index is the innermost
    for (const std::uint64_t size : sizes) {
      // No overflow: both factors are below 2^32.
      type = add({.kind = Kind::kArray,
                  .element = type,
                  .bound = size,
                  .depth = type->depth + 1,
                  .least_bytes = size * type->least_bytes});
    }
    return {std::move(name), type};
  }

  // --- definitions

  void addMember(Type& type, Member member) const {
    if (type.members.size() == kMaxMembers) lexer_.failBeyond(kMaxMembers, "members");
    if (std::ranges::count(type.members, member.name, &Member::name) > 0) {
      lexer_.fail("each member's name once", "'" + member.name + "' again");
    }
    type.depth = std::max(type.depth, member.type->depth + 1);
    type.members.push_back(std::move(member));
  }

  /// For a type that has no name of its own.
  void addName(const std::string& full_name, const Type* type) {
    if (names_.size() >= kMaxDefinitions) lexer_.failBeyond(kMaxDefinitions, "names");
    names_.addType(full_name, type);
  }

  // --- types that are declared before they are defined, and those that contain sequences of themselves

  /// The struct or union of that name, to be defined; a declaration has made it or this does.
  Type& declared(const std::string& short_name, Kind kind) {
    const auto known = open_.find(names_.scope() + short_name);
    const bool is_known = known != open_.end() && set_.find(known->first) == known->second.type;
    if (is_known && known->second.type->kind == kind) return *known->second.type;
    const std::size_t line = lexer_.token().line;
    const std::string name = names_.claim(short_name);
    Type* type = add({.kind = kind, .name = name});
    names_.addType(name, type);
    open_[name] = {type, line};
    return *type;
  }

  /// One whose definition has been there already stays as it is.
  const Type* forward(const std::string& short_name, Kind kind) {
    if (names_.isNew(short_name)) (void)declared(short_name, kind);
    return nullptr;
  }

  const Type* finish(Type& slot, Type type) {
    slot = checked(std::move(type));
    open_.erase(slot.name);
    return &slot;
  }

  void expectDefined(const Type& type) const {
    if (!open_.contains(type.name)) return;
    lexer_.fail("a type that is defined before, or a sequence of one that is not (recursion)", "'" + type.name + "'");
  }

  /// What is declared and nowhere defined costs those that use it.
  void dropUndefined() {
    TypeUsers users(set_.types_, set_.names_);
    for (const auto& [name, declaration] : open_) dropUsers(name, declaration.line, users.take(*declaration.type));
  }

  void dropUsers(const std::string& undefined, std::size_t line, const std::vector<std::string>& names) {
    const bool is_used = std::ranges::any_of(names, [&](const std::string& one) { return one != undefined; });
    const auto known = set_.unusable_.find(undefined);
    if (!is_used && known == set_.unusable_.end()) {
      set_.names_.erase(undefined);
      return;
    }
    const std::size_t problem = known != set_.unusable_.end()
                                    ? known->second
                                    : addProblem(undefined, "line " + std::to_string(line) +
                                                                ": expected its definition, found a declaration alone");
    for (const std::string& one : names) names_.addUnusable(one, problem);
  }

  /// The base's members come first, as in a payload.
  void inherit(Type& type) {
    const std::size_t line = lexer_.token().line;
    const Type& base = *names_.type();
    expectDefined(base);
    if (base.kind != Kind::kStruct) failAt(line, "a struct to inherit from", "another type");
    for (const Member& one : base.members) inherited_bytes_ += sizeof one + one.name.size() + one.unit.size();
    if (inherited_bytes_ > kMaxInheritedBytes) lexer_.failBeyond(kMaxInheritedBytes, "bytes of inherited members");
    type.members = base.members;
    type.depth = base.depth;
    type.least_bytes = base.least_bytes;
  }

  const Type* structure() {
    const std::string short_name = lexer_.name("a struct's name");
    if (lexer_.is(";")) return forward(short_name, Kind::kStruct);
    Type& slot = declared(short_name, Kind::kStruct);
    Type type{.kind = Kind::kStruct, .name = slot.name};
    if (lexer_.accept(":")) inherit(type);
    lexer_.expect("{");
    while (!lexer_.accept("}")) {
      const Annotations marks = annotations_.read();
      const Type* member_type = typeName();
      do {
        auto [name, declared] = declarator(member_type);
        type.least_bytes += declared->least_bytes;
        addMember(type, {std::move(name), declared, marks.unit, marks.is_key});
      } while (lexer_.accept(","));
      lexer_.expect(";");
    }
    return finish(slot, std::move(type));
  }

  std::int64_t enumerator() {
    return values_.integer(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max());
  }

  const Type* enumeration(std::int64_t bits) {
    if (bits <= kMostBitsOfShortEnum || bits > kBitsOfEnum) {
      lexer_.fail("an enum of four bytes", "@bit_bound(" + std::to_string(bits) + "), which is not supported");
    }
    Type type{.kind = Kind::kEnum, .name = names_.claim(lexer_.name("an enum's name")), .least_bytes = 4};
    std::set<std::string> full_names{type.name};
    std::int64_t value = 0;
    lexer_.expect("{");
    do {
      if (type.enumerators.size() == kMaxEnumerators) lexer_.failBeyond(kMaxEnumerators, "enumerators");
      const Annotations marks = annotations_.read();
      const std::string name = lexer_.name("an enumerator");
      if (!full_names.insert(names_.claim(name)).second) lexer_.fail("a new name", "'" + name + "' again");
      value = lexer_.accept("=") ? enumerator() : marks.value.value_or(value);
      if (!type.enumerators.emplace(value++, name).second)
        lexer_.fail("each value once", "that of '" + name + "' again");
    } while (lexer_.accept(","));
    lexer_.expect("}");
    const Type* added = add(std::move(type));
    names_.addType(added->name, added);
    for (const auto& [number, name] : added->enumerators) {
      // IDL has them beside the enum; some also say Enum::NAME.
      names_.addConstant(names_.claim(name), {added, number});
      names_.addConstant(added->name + "::" + name, {added, number});
    }
    return added;
  }

  /// An unsigned integer of as many bits; what the bits are called is not kept.
  void bitmask(std::int64_t bits) {
    const Type* integer = primitives_.at(bits <= 8    ? "uint8"
                                         : bits <= 16 ? "uint16"
                                         : bits <= 32 ? "uint32"
                                                      : "uint64");
    const std::string name = names_.claim(lexer_.name("a bitmask's name"));
    std::int64_t position = 0;
    std::set<std::int64_t> positions;
    lexer_.expect("{");
    do {
      position = annotations_.read().position.value_or(position);
      (void)lexer_.name("a bit's name");
      if (position >= bits) lexer_.fail("a bit below " + std::to_string(bits), std::to_string(position));
      if (!positions.insert(position).second) lexer_.fail("each bit once", std::to_string(position) + " again");
      ++position;
    } while (lexer_.accept(","));
    lexer_.expect("}");
    addName(name, integer);
  }

  void labels(Type& type) {
    const std::size_t member = type.members.size();
    do {
      if (lexer_.accept("default")) {
        if (type.default_member != 0) lexer_.fail("one default", "another");
        type.default_member = member;
      } else {
        lexer_.expect("case");
        const auto value = static_cast<std::int64_t>(values_.value(*type.members.front().type).value());
        if (type.labels.size() == kMaxMembers) lexer_.failBeyond(kMaxMembers, "labels");
        if (std::ranges::count(type.labels, value, &Label::value) > 0) lexer_.fail("each label once", "one again");
        type.labels.push_back({value, member});
      }
      lexer_.expect(":");
    } while (lexer_.is("case") || lexer_.is("default"));
  }

  const Type* unite() {
    const std::string short_name = lexer_.name("a union's name");
    if (lexer_.is(";")) return forward(short_name, Kind::kUnion);
    Type& slot = declared(short_name, Kind::kUnion);
    Type type{.kind = Kind::kUnion, .name = slot.name};
    lexer_.expect("switch");
    lexer_.expect("(");
    (void)annotations_.read();
    const Type* discriminator = typeName();
    if (!isDiscriminator(discriminator->kind)) {
      lexer_.fail("a switch on an enum, a boolean, a character or an integer", "another type");
    }
    lexer_.expect(")");
    type.least_bytes = discriminator->least_bytes;
    addMember(type, {std::string(kDiscriminator), discriminator});
    lexer_.expect("{");
    do {
      labels(type);
      const Annotations marks = annotations_.read();
      auto [name, declared] = declarator(typeName());
      addMember(type, {std::move(name), declared, marks.unit, marks.is_key});
      lexer_.expect(";");
    } while (!lexer_.accept("}"));
    return finish(slot, std::move(type));
  }

  bool isConstructed() const { return lexer_.is("struct") || lexer_.is("union") || lexer_.is("enum"); }

  /// Null when it is to come.
  const Type* constructed(const Annotations& marks) {
    if (lexer_.accept("struct")) return structure();
    if (lexer_.accept("union")) return unite();
    lexer_.expect("enum");
    return enumeration(marks.bit_bound.value_or(kBitsOfEnum));
  }

  void typeDefinition(const Annotations& marks) {
    const Type* type = isConstructed() ? constructed(marks) : typeName();
    if (type == nullptr) lexer_.fail("'{'");
    do {
      const auto [name, declared] = declarator(type);
      addName(names_.claim(name), declared);
    } while (lexer_.accept(","));
  }

  void constant() {
    const Type* type = typeName();
    if (type->kind > Kind::kEnum) {
      lexer_.fail("a constant that is a number, a boolean, a character, a string or of an enum", "one of another type");
    }
    const std::string name = names_.claim(lexer_.name("a constant's name"));
    lexer_.expect("=");
    names_.addConstant(name, {type, values_.value(*type)});
  }

  void module(unsigned depth) {
    if (depth == kMaxDepth) lexer_.failBeyond(kMaxDepth, "modules within each other");
    const std::string outer = names_.enter(lexer_.name("a module's name"));
    lexer_.expect("{");
    while (!atEnd() && !lexer_.is("}")) definition(depth + 1);
    lexer_.expect("}");
    names_.leave(outer);
  }

  /// Between definitions a line for the preprocessor changes none of them.
  bool atEnd() {
    while (lexer_.token().kind == Token::Kind::kDirective) lexer_.advance();
    return lexer_.token().kind == Token::Kind::kEnd;
  }

  /// One that cannot be used is passed over, with its names.
  void definition(unsigned depth) {
    const IdlLexer begin = lexer_;
    const std::string scope = names_.scope();
    std::string problem;
    try {
      return define(depth);
    } catch (const UnusableName& error) {
      giveUp(begin, scope, error.problem());
    } catch (const IdlError& error) {
      problem = error.what();
    }
    if (problem.empty()) return;
    const std::size_t index = addProblem("", std::move(problem));
    set_.problems_[index].definition = giveUp(begin, scope, index);
  }

  /// Returns its index.
  std::size_t addProblem(std::string definition, std::string text) {
    if (set_.problems_.size() == kMaxProblems) lexer_.failBeyond(kMaxProblems, "definitions that cannot be read");
    set_.problems_.push_back({std::move(definition), std::move(text)});
    return set_.problems_.size() - 1;
  }

  /// Goes on behind the definition that begins there. Returns one of its names.
  std::string giveUp(const IdlLexer& begin, const std::string& scope, std::size_t problem) {
    lexer_ = begin;
    names_.leave(scope);
    nesting_ = 0;
    std::string name;
    for (const std::string& one : skipDefinition(lexer_)) {
      name = scope + one;
      if (names_.size() >= kMaxDefinitions) lexer_.failBeyond(kMaxDefinitions, "names");
      if (name.size() <= kMaxNameBytes) names_.addUnusable(name, problem);
    }
    return name;
  }

  void define(unsigned depth) {
    const Annotations marks = annotations_.read();
    if (marks.is_declaration) {
      (void)lexer_.name("an annotation's name");
      lexer_.expect("{");
      lexer_.skipTo("}", "{");
    } else if (lexer_.accept("module")) {
      module(depth);
    } else if (isConstructed()) {
      constructed(marks);
    } else if (lexer_.accept("bitmask")) {
      bitmask(marks.bit_bound.value_or(kBitsOfBitmask));
    } else if (lexer_.accept("typedef")) {
      typeDefinition(marks);
    } else if (lexer_.accept("const")) {
      constant();
    } else {
      lexer_.fail("module, struct, union, enum, bitmask, typedef or const");
    }
    lexer_.expect(";");
  }

  IdlLexer lexer_;
  TypeSet set_;
  IdlNames names_{lexer_, set_.names_, set_.unusable_};
  IdlValues values_{lexer_, names_};
  IdlAnnotations annotations_{lexer_, values_};
  std::map<std::string_view, const Type*> primitives_;
  struct Declaration {
    Type* type = nullptr;
    std::size_t line = 1;
  };
  std::map<std::string, Declaration> open_;  // structs and unions that are declared and not defined so far
  unsigned nesting_ = 0;
  std::size_t inherited_bytes_ = 0;
};

TypeSet parseIdl(std::string_view text) {
  if (text.size() > kMaxTextBytes) {
    failAt(1, "at most " + std::to_string(kMaxTextBytes) + " bytes", std::to_string(text.size()));
  }
  const std::string plain = preprocessed(text);
  return IdlParser(plain).parse();
}

}  // namespace baton::schema
