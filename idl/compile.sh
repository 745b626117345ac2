#!/bin/sh
# One IDL file through one tool; any warning is an error. Called by idl/CMakeLists.txt.
#   compile.sh fastdds FILE.idl INCLUDE_DIR OUT_DIR     types for the services: OUT_DIR/FILE.h, OUT_DIR/FILE.cxx
#   compile.sh cyclone FILE.idl INCLUDE_DIR OUT_DIR     proves that Cyclone DDS accepts the file
#   compile.sh flatten FILE.idl INCLUDE_DIR OUT_FILE    the text that recordings carry: no comments, no preprocessor lines
set -eu
tool=$1 idl=$2 include=$3 out=$4

case $tool in
  fastdds)
    mkdir -p "$out"
    # fastddsgen writes the types of included files too, and preprocessed files beside: several at once must not share a
    # directory, and only this file's own types are taken over.
    scratch=$(mktemp -d)
    trap 'rm -rf "$scratch"' EXIT
    mkdir "$scratch/types"
    log=$(fastddsgen -cs -replace -t "$scratch" -I "$include" -d "$scratch/types" "$idl" 2>&1) || { printf '%s\n' "$log" >&2; exit 1; }
    name=$(basename "$idl" .idl)
    # For a sequence of strings fastddsgen 2.3 makes as much room as the payload claims to need before it looks whether
    # the bytes are there: a forged length would ask for gigabytes.
    sed -i 's/^\( *\)\(m_[A-Za-z_]*\.resize(sequence_size);\)/\1if (sequence_size > 1024) throw eprosima::fastcdr::exception::NotEnoughMemoryException("a sequence of strings is too long");\n\1\2/' \
      "$scratch/types/$name.cxx"
    mv "$scratch/types/$name."* "$scratch/types/${name}PubSubTypes."* "$out"
    # fastddsgen 2.3 does not know @unit and says so each time; the annotation is for the tools that read recordings.
    problems=$(printf '%s\n' "$log" | grep -iE 'warning|error' | grep -v 'Annotation unit not supported' || true)
    ;;
  cyclone)
    mkdir -p "$out"
    cd "$out"
    problems=$(idlc -f case-sensitive -I "$include" "$idl" 2>&1) || { printf '%s\n' "$problems" >&2; exit 1; }
    ;;
  flatten)
    cc -x c++ -E -P -undef -nostdinc -I "$include" "$idl" >"$out"
    problems=
    ;;
  *)
    echo "compile.sh: expected fastdds, cyclone or flatten, found $tool" >&2
    exit 2
    ;;
esac
if [ -n "$problems" ]; then
  printf '%s: %s warns, which is an error here:\n%s\n' "$idl" "$tool" "$problems" >&2
  exit 1
fi
