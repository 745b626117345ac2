#!/bin/sh
# One IDL file through one tool. Called by idl/CMakeLists.txt. Paths are absolute. A warning is told, and is an error when
# BATON_WARNINGS_AS_ERRORS is ON in the environment.
#   compile.sh fastdds FILE.idl INCLUDE_DIR OUT_DIR     types for the services: OUT_DIR/FILE.h, OUT_DIR/FILE.cxx
#   compile.sh cyclone FILE.idl INCLUDE_DIR OUT_DIR     proves that Cyclone DDS accepts the file
#   compile.sh flatten FILE.idl INCLUDE_DIR OUT_FILE    the text that recordings carry: no comments, no preprocessor lines
#
# fastddsgen 2.3 (Debian 12) and 4.0 (Debian 13) write different code. What is done to it here makes the same names and
# the same checks of it; each change is counted, so that a fastddsgen that writes otherwise breaks the build.
set -eu
unset JAVA_TOOL_OPTIONS JDK_JAVA_OPTIONS _JAVA_OPTIONS  # fastddsgen is Java's, which repeats these on standard error
tool=$1 idl=$2 include=$3 out=$4

fail() {
  printf '%s: %s\n' "$idl" "$1" >&2
  exit 1
}

# Lines of a file that match, 0 included.
count() { grep -cE "$1" "$2" || true; }

structs() { count '^ *@final struct ' "$idl"; }

# expect WHAT FOUND WANTED
expect() { [ "$2" = "$3" ] || fail "expected fastddsgen to write $3 $1, found $2: look at its code and teach compile.sh"; }

# For a sequence of strings fastddsgen 2.3 makes as much room as the payload claims to need before it looks whether the
# bytes are there: a forged length would ask for gigabytes. (Fast CDR 2 looks first.)
limit_sequences_of_strings() {
  refuse='throw eprosima::fastcdr::exception::NotEnoughMemoryException("a sequence of strings is too long");'
  sed -i 's/^\( *\)\(m_[A-Za-z_]*\.resize(sequence_size);\)/\1if (sequence_size > 1024) '"$refuse"'\n\1\2/' "$1"
  expect "sequences of strings" "$(count 'if \(sequence_size > 1024\)' "$1")" "$(count 'sequence<string' "$idl")"
  expect "sizes of sequences of strings" "$(count 'resize\(sequence_size\)' "$1")" "$(count 'sequence<string' "$idl")"
}

# fastddsgen 4 writes scoped enums, 2.3 does not.
unscope_enums() {
  sed -i 's/^enum class \([A-Za-z]*\) : int32_t$/enum \1 : int32_t/' "$1"
  expect "enums" "$(count '^enum [A-Za-z]* : int32_t$' "$1")" "$(count '^ *enum ' "$idl")"
}

# Code of fastddsgen 4 accepts a payload that ends after any member of its message.
read_every_member() {
  sed -i 's/cdr\.deserialize_type(/baton::msg::readEveryMember(cdr, /' "$1"
  sed -i '1i #include "msg/cdr.hpp"' "$1"
  expect "types to read" "$(count 'readEveryMember' "$1")" "$(structs)"
}

# What 2.3 has in FILE.h, FILE.cxx and FILEPubSubTypes is in more files with 4; and the room that a type takes is here found
# by the type.
name_as_fastddsgen_2_does() {
  {
    printf '#pragma once\n#include "%s.hpp"\n#include "%sCdrAux.hpp"\n#include "msg/cdr.hpp"\n' "$name" "$name"
    sed -n 's/^constexpr uint32_t \(baton_msg_\([A-Za-z]*\)_max_cdr_typesize\) .*/template <>\ninline constexpr std::size_t baton::msg::max_cdr_size<baton::msg::\2> = \1;/p' \
      "$types/${name}CdrAux.hpp"
  } >"$types/$name.h"
  expect "sizes of types" "$(count '^inline constexpr' "$types/$name.h")" "$(structs)"
  printf '#include "%sCdrAux.ipp"\n' "$name" >"$types/$name.cxx"
  printf '#pragma once\n#include "%sPubSubTypes.hpp"\n' "$name" >"$types/${name}PubSubTypes.h"
  printf '#include "%sTypeObjectSupport.cxx"\n' "$name" >>"$types/${name}PubSubTypes.cxx"
}

case $tool in
  fastdds)
    mkdir -p "$out"
    # fastddsgen writes the types of included files too, and preprocessed files beside: several at once must not share a
    # directory, and only this file's own types are taken over.
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    types=$scratch/types
    mkdir "$types"
    name=$(basename "$idl" .idl)
    # It is called where the files are: it repeats paths in what it says, where folders may have any name, and fastddsgen 4
    # repeats them below OUT_DIR.
    cp "$include"/*.idl "$scratch"
    cd "$scratch"
    log=$(fastddsgen -cs -replace -t . -I . -d types "$name.idl" 2>&1) || { printf '%s\n' "$log" >&2; exit 1; }
    # fastddsgen 2.3 does not know @unit and says so each time; the annotation is for the tools that read recordings.
    # fastddsgen 4 exits with 0 after some exceptions.
    said=$(printf '%s\n' "$log" | grep -v 'Annotation unit not supported' || true)
    ! printf '%s\n' "$said" | grep -qiE 'error|exception' || fail "fastddsgen could not compile it: $log"
    warnings=$(printf '%s\n' "$said" | grep -i 'warning' || true)
    if [ -e "$types/$name.hpp" ]; then
      unscope_enums "$types/$name.hpp"
      read_every_member "$types/${name}CdrAux.ipp"
      name_as_fastddsgen_2_does
    else
      limit_sequences_of_strings "$types/$name.cxx"
    fi
    for kind in "" CdrAux PubSubTypes TypeObjectSupport; do
      for file in "$types/$name$kind."*; do
        if [ -e "$file" ]; then mv "$file" "$out"; fi
      done
    done
    ;;
  cyclone)
    mkdir -p "$out"
    cd "$out"
    warnings=$(idlc -f case-sensitive -I "$include" "$idl" 2>&1) || { printf '%s\n' "$warnings" >&2; exit 1; }
    ;;
  flatten)
    cc -x c++ -E -P -undef -nostdinc -I "$include" "$idl" >"$out"
    warnings=
    ;;
  *)
    echo "compile.sh: expected fastdds, cyclone or flatten, found $tool" >&2
    exit 2
    ;;
esac
if [ -n "$warnings" ]; then
  printf '%s: %s warns:\n%s\n' "$idl" "$tool" "$warnings" >&2
  [ "${BATON_WARNINGS_AS_ERRORS:-OFF}" != ON ] || exit 1
fi
