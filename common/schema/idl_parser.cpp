#include "schema/idl_parser.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "schema/idl_lexer.hpp"
#include "schema/idl_names.hpp"
#include "schema/limits.hpp"

namespace baton::schema {
namespace {

struct Primitive {
  std::string_view words;
  Kind kind;
  std::uint64_t bytes;
};
constexpr std::array kPrimitives{
    Primitive{"boolean", Kind::kBoolean, 1},
    Primitive{"octet", Kind::kOctet, 1},
    Primitive{"char", Kind::kChar, 1},
    Primitive{"int8", Kind::kInt8, 1},
    Primitive{"uint8", Kind::kUint8, 1},
    Primitive{"int16", Kind::kInt16, 2},
    Primitive{"short", Kind::kInt16, 2},
    Primitive{"uint16", Kind::kUint16, 2},
    Primitive{"unsigned short", Kind::kUint16, 2},
    Primitive{"int32", Kind::kInt32, 4},
    Primitive{"long", Kind::kInt32, 4},
    Primitive{"uint32", Kind::kUint32, 4},
    Primitive{"unsigned long", Kind::kUint32, 4},
    Primitive{"int64", Kind::kInt64, 8},
    Primitive{"long long", Kind::kInt64, 8},
    Primitive{"uint64", Kind::kUint64, 8},
    Primitive{"unsigned long long", Kind::kUint64, 8},
    Primitive{"float", Kind::kFloat, 4},
    Primitive{"double", Kind::kDouble, 8},
    Primitive{"string", Kind::kString, 4},
};

// Annotations that put a member elsewhere than its place among the others, or nowhere.
constexpr std::array<std::string_view, 3> kMoving{"optional", "non_serialized", "nonserialized"};
// An enum with fewer bits takes one byte or two in the payloads of some vendors and four in those of others.
constexpr std::int64_t kMostBitsOfShortEnum = 16, kBitsOfEnum = 32;

/// Older IDL of some vendors writes @Key and @Extensibility(FINAL_EXTENSIBILITY).
std::string lowerCase(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return lower;
}

std::string atMost(std::uint64_t limit, const std::string& what) {
  return "at most " + std::to_string(limit) + " " + what;
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
    return std::move(set_);
  }

 private:
  struct Annotations {
    std::string unit;
    bool is_key = false;
    std::optional<std::int64_t> value;  // of an enumerator
    bool is_declaration = false;        // what follows says what an annotation is
  };

  Annotations annotations() {
    Annotations all;
    while (lexer_.accept("@")) {
      const std::string name = annotationName();
      if (name == "unit") {
        all.unit = unit();
      } else if (name == "value") {
        all.value = enumerationValue();
      } else if (name == "bit_bound") {
        bitBound();
      } else if (name == "extensibility") {
        expectPlain(extensibility());
      } else if (std::ranges::count(kMoving, name) > 0) {
        lexer_.fail("a member that always has its place in a payload", "@" + name + ", which is not supported");
      } else {
        all.is_key = all.is_key || name == "key";
        all.is_declaration = all.is_declaration || name == "annotation";
        expectPlain(name);
        if (lexer_.accept("(")) skipTo(")", "(");
      }
    }
    return all;
  }

  /// Without the vendor's or module's name before it.
  std::string annotationName() {
    std::string name;
    do {
      if (lexer_.token().kind != Token::Kind::kWord) lexer_.fail("an annotation's name");
      name = lowerCase(lexer_.token().text);
      lexer_.advance();
    } while (lexer_.accept("::"));
    return name;
  }

  /// Final and appendable types are the same in plain CDR.
  void expectPlain(const std::string& extensibility) const {
    if (extensibility.starts_with("mutable")) {
      lexer_.fail("a final or an appendable type", "a mutable one, whose parameter lists are not supported");
    }
  }

  std::string extensibility() {
    openArgument();
    const std::string kind = lexer_.token().kind == Token::Kind::kWord ? lowerCase(lexer_.token().text) : "";
    for (const char* known : {"final", "appendable", "extensible", "mutable"}) {
      if (!kind.starts_with(known)) continue;
      lexer_.advance();
      lexer_.expect(")");
      return kind;
    }
    lexer_.fail("FINAL, APPENDABLE or MUTABLE");
  }

  void bitBound() {
    openArgument();
    const std::int64_t bits = names_.integer(1, 64);
    lexer_.expect(")");
    if (bits > kMostBitsOfShortEnum && bits <= kBitsOfEnum) return;
    lexer_.fail("an enum of four bytes", "@bit_bound(" + std::to_string(bits) + "), which is not supported");
  }

  std::int64_t enumerationValue() {
    openArgument();
    const std::int64_t value = anyEnumerator();
    lexer_.expect(")");
    return value;
  }
  std::int64_t anyEnumerator() {
    return names_.integer(std::numeric_limits<std::int32_t>::min(), std::numeric_limits<std::int32_t>::max());
  }

  std::string unit() {
    openArgument();
    if (lexer_.token().kind != Token::Kind::kString) lexer_.fail("the unit as a string");
    std::string text(lexer_.token().text);
    lexer_.advance();
    lexer_.expect(")");
    return text;
  }

  /// An annotation's only argument may be called by its name.
  void openArgument() {
    lexer_.expect("(");
    if (lexer_.accept("value")) lexer_.expect("=");
  }

  /// Up to the end of what was opened, with all that is opened within.
  void skipTo(std::string_view end, std::string_view begin) {
    for (std::size_t open = 1; open > 0; lexer_.advance()) {
      const Token::Kind kind = lexer_.token().kind;
      if (kind == Token::Kind::kEnd || kind == Token::Kind::kBad || (end == ")" && lexer_.is(";"))) {
        lexer_.fail("'" + std::string(end) + "'");
      }
      open += lexer_.is(begin) ? 1 : 0;
      open -= lexer_.is(end) ? 1 : 0;
    }
  }

  const Type* add(Type type) {
    if (set_.types_.size() >= kMaxDefinitions) lexer_.fail(atMost(kMaxDefinitions, "types"), "more");
    if (type.depth > kMaxDepth) lexer_.fail(atMost(kMaxDepth, "types within each other"), "more");
    if (type.least_bytes > kMaxLeastBytes) lexer_.fail(atMost(kMaxLeastBytes, "bytes for a value"), "a larger type");
    return &set_.types_.emplace_back(std::move(type));
  }

  std::uint64_t bound() {
    return static_cast<std::uint64_t>(names_.integer(1, std::numeric_limits<std::uint32_t>::max()));
  }

  // --- types by name

  const Type* typeName() {
    if (lexer_.accept("sequence")) return sequence();
    const bool is_primitive =
        std::ranges::any_of(kPrimitives, [&](const Primitive& one) { return lexer_.is(one.words); });
    if (!is_primitive && !lexer_.is("unsigned")) return names_.type();
    std::string words(lexer_.token().text);
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
    if (++nesting_ > kMaxDepth) lexer_.fail(atMost(kMaxDepth, "types within each other"), "more");
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
    std::string name = lexer_.name("a name");
    std::vector<std::uint64_t> sizes;
    while (lexer_.accept("[")) {
      if (sizes.size() == kMaxDepth) lexer_.fail(atMost(kMaxDepth, "dimensions"), "more");
      sizes.push_back(bound());
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
    if (type.members.size() == kMaxMembers) lexer_.fail(atMost(kMaxMembers, "members"), "more");
    if (std::ranges::count(type.members, member.name, &Member::name) > 0) {
      lexer_.fail("each member's name once", "'" + member.name + "' again");
    }
    type.depth = std::max(type.depth, member.type->depth + 1);
    type.members.push_back(std::move(member));
  }

  const Type* finish(Type type) {
    const std::string name = type.name;
    const Type* added = add(std::move(type));
    names_.addType(name, added);
    return added;
  }

  void structure() {
    const std::string short_name = lexer_.name("a struct's name");
    if (lexer_.is(";")) return;  // it is to come
    Type type{.kind = Kind::kStruct, .name = names_.claim(short_name)};
    lexer_.expect("{");
    do {
      const Annotations marks = annotations();
      const Type* member_type = typeName();
      do {
        auto [name, declared] = declarator(member_type);
        type.least_bytes += declared->least_bytes;
        addMember(type, {std::move(name), declared, marks.unit, marks.is_key});
      } while (lexer_.accept(","));
      lexer_.expect(";");
    } while (!lexer_.accept("}"));
    finish(std::move(type));
  }

  void enumeration() {
    Type type{.kind = Kind::kEnum, .name = names_.claim(lexer_.name("an enum's name")), .least_bytes = 4};
    std::set<std::string> full_names{type.name};
    std::int64_t value = 0;
    lexer_.expect("{");
    do {
      if (type.enumerators.size() == kMaxEnumerators) lexer_.fail(atMost(kMaxEnumerators, "enumerators"), "more");
      const Annotations marks = annotations();
      const std::string name = lexer_.name("an enumerator");
      if (!full_names.insert(names_.claim(name)).second) lexer_.fail("a new name", "'" + name + "' again");
      value = lexer_.accept("=") ? anyEnumerator() : marks.value.value_or(value);
      if (!type.enumerators.emplace(value++, name).second)
        lexer_.fail("each value once", "that of '" + name + "' again");
    } while (lexer_.accept(","));
    lexer_.expect("}");
    const Type* added = finish(std::move(type));
    for (const auto& [number, name] : added->enumerators) {
      // IDL has them beside the enum; some also say Enum::NAME.
      names_.addConstant(names_.claim(name), {added, number});
      names_.addConstant(added->name + "::" + name, {added, number});
    }
  }

  void labels(Type& type) {
    const std::size_t member = type.members.size();
    do {
      if (lexer_.accept("default")) {
        if (type.default_member != 0) lexer_.fail("one default", "another");
        type.default_member = member;
      } else {
        lexer_.expect("case");
        const std::int64_t value = names_.value(*type.members.front().type).value();
        if (type.labels.size() == kMaxMembers) lexer_.fail(atMost(kMaxMembers, "labels"), "more");
        if (std::ranges::count(type.labels, value, &Label::value) > 0) lexer_.fail("each label once", "one again");
        type.labels.push_back({value, member});
      }
      lexer_.expect(":");
    } while (lexer_.is("case") || lexer_.is("default"));
  }

  void unite() {
    const std::string short_name = lexer_.name("a union's name");
    if (lexer_.is(";")) return;
    Type type{.kind = Kind::kUnion, .name = names_.claim(short_name)};
    lexer_.expect("switch");
    lexer_.expect("(");
    (void)annotations();
    const Type* discriminator = typeName();
    const Kind kind = discriminator->kind;
    if (kind != Kind::kEnum && kind != Kind::kBoolean && !isInteger(kind)) {
      lexer_.fail("a switch on an enum, a boolean or an integer", "another type");
    }
    lexer_.expect(")");
    type.least_bytes = discriminator->least_bytes;
    addMember(type, {std::string(kDiscriminator), discriminator});
    lexer_.expect("{");
    do {
      labels(type);
      const Annotations marks = annotations();
      auto [name, declared] = declarator(typeName());
      addMember(type, {std::move(name), declared, marks.unit, marks.is_key});
      lexer_.expect(";");
    } while (!lexer_.accept("}"));
    finish(std::move(type));
  }

  void typeDefinition() {
    const Type* type = typeName();
    do {
      const auto [name, declared] = declarator(type);
      if (names_.size() >= kMaxDefinitions) lexer_.fail(atMost(kMaxDefinitions, "names"), "more");
      names_.addType(names_.claim(name), declared);
    } while (lexer_.accept(","));
  }

  void constant() {
    const Type* type = typeName();
    if (type->kind > Kind::kEnum || type->kind == Kind::kOctet || type->kind == Kind::kChar) {
      lexer_.fail("a constant that is a number, a boolean, a string or of an enum", "one of another type");
    }
    const std::string name = names_.claim(lexer_.name("a constant's name"));
    lexer_.expect("=");
    names_.addConstant(name, {type, names_.value(*type)});
  }

  void module(unsigned depth) {
    if (depth == kMaxDepth) lexer_.fail(atMost(kMaxDepth, "modules within each other"), "more");
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
    if (set_.problems_.size() == kMaxProblems)
      lexer_.fail(atMost(kMaxProblems, "definitions that cannot be read"), "more");
    const std::size_t index = set_.problems_.size();
    set_.problems_.push_back({"", std::move(problem)});
    set_.problems_[index].definition = giveUp(begin, scope, index);
  }

  /// Goes on behind the definition that begins there. Returns one of its names.
  std::string giveUp(const IdlLexer& begin, const std::string& scope, std::size_t problem) {
    lexer_ = begin;
    names_.leave(scope);
    nesting_ = 0;
    std::string name;
    for (const std::string& one : skipDefinition()) {
      name = scope + one;
      if (names_.size() >= kMaxDefinitions) lexer_.fail(atMost(kMaxDefinitions, "names"), "more");
      if (name.size() <= kMaxNameBytes) names_.addUnusable(name, problem);
    }
    return name;
  }

  /// Up to the ';' behind it, or to the '}' around it. Returns the names it declares: those before ',', ';' or '[' in a
  /// typedef, else the one before its body, its base, its value or its end.
  std::vector<std::string> skipDefinition() {
    std::vector<std::string> names;
    bool is_typedef = false;
    std::size_t within = 0, braces = 0;  // of any kind; of these alone
    std::string_view word;
    for (bool is_first = true;; is_first = false) {
      const Token token = lexer_.token();
      const bool ends = lexer_.is(";") && braces == 0;
      if (token.kind == Token::Kind::kEnd || (lexer_.is("}") && braces == 0 && !is_first)) return names;
      is_typedef = is_typedef || (within == 0 && lexer_.is("typedef"));
      const auto isOneOf = [&](std::string_view signs) {
        return token.kind == Token::Kind::kSign && token.text.size() == 1 && signs.find(token.text) != signs.npos;
      };
      const bool is_declared = is_typedef ? isOneOf(",;[") : names.empty() && (isOneOf("{:;=") || lexer_.is("switch"));
      if (within == 0 && is_declared && !word.empty()) names.emplace_back(word);
      if (isOneOf("{([<")) ++within;
      if (isOneOf("})]>") && within > 0) --within;
      braces += lexer_.is("{") ? 1 : 0;
      braces -= lexer_.is("}") && braces > 0 ? 1 : 0;
      word = token.kind == Token::Kind::kWord ? token.text : "";
      lexer_.advance();
      if (ends) return names;
    }
  }

  void define(unsigned depth) {
    if (annotations().is_declaration) {
      (void)lexer_.name("an annotation's name");
      lexer_.expect("{");
      skipTo("}", "{");
    } else if (lexer_.accept("module")) {
      module(depth);
    } else if (lexer_.accept("struct")) {
      structure();
    } else if (lexer_.accept("union")) {
      unite();
    } else if (lexer_.accept("enum")) {
      enumeration();
    } else if (lexer_.accept("typedef")) {
      typeDefinition();
    } else if (lexer_.accept("const")) {
      constant();
    } else {
      lexer_.fail("module, struct, union, enum, typedef or const");
    }
    lexer_.expect(";");
  }

  IdlLexer lexer_;
  TypeSet set_;
  IdlNames names_{lexer_, set_.names_, set_.unusable_};
  std::map<std::string_view, const Type*> primitives_;
  unsigned nesting_ = 0;
};

TypeSet parseIdl(std::string_view text) {
  if (text.size() > kMaxTextBytes) failAt(1, atMost(kMaxTextBytes, "bytes"), std::to_string(text.size()));
  return IdlParser(text).parse();
}

}  // namespace baton::schema
