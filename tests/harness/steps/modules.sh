#!/usr/bin/env bash
# checks that no modules depend on each other in a cycle and no crate on one above it, and that the check can fail
. tests/harness/lib.sh
check "no circle, no dependency that points up" python3 tests/harness/modules.py
grep -E '^[a-z-]+: [0-9]+ modules' "$log" | sed 's/^/   /'

# A check that cannot fail proves nothing: it must find each of these.
readonly planted=$OLEO_LOGS/planted
plant() { mkdir -p "$(dirname "$planted/$1")" && cat > "$planted/$1"; }
crate() { plant Cargo.toml <<< "[package]
name = \"$1\"
[dependencies]
${2:+$2 = {\}}"; }
finds() { # TEXT: the check fails, and says so
    local said
    said=$(python3 tests/harness/modules.py "$planted") && { echo "passed: $said"; return 1; }
    grep -F "$1" <<< "$said" || { echo "$said"; return 1; }
}

crate oleo-interface
plant src/lib.rs <<< 'mod a; mod b; mod c;'
plant src/a.rs <<< 'pub struct A(pub crate::b::B);'
plant src/b.rs <<< 'pub struct B; fn f() { let _: Option<super::c::C> = None; }'
plant src/c.rs <<< '// crate::a in a comment is nothing, nor is "crate::a" in a text
    pub struct C; #[cfg(test)] mod tests { use crate::a::A; }'
check "three modules in a row are no circle" python3 tests/harness/modules.py "$planted"
plant src/c.rs <<< 'pub struct C; fn f() { crate::a::g(); }'
check "a circle of three modules is found" finds \
    'circle of oleo-interface::a, oleo-interface::b, oleo-interface::c'

# A text may go on in the next line; what stands behind it counts all the same.
plant src/c.rs <<< 'pub struct C; fn f() { let _ = "one \
    two"; crate::a::g(); }'
check "a circle behind a text of two lines is found" finds \
    'circle of oleo-interface::a, oleo-interface::b, oleo-interface::c'

plant src/c.rs <<< 'pub struct C;'
plant src/a.rs <<< 'mod inner; pub use inner::Inner; pub struct Own;'
plant src/a/inner.rs <<< 'pub struct Inner(crate::b::B);'
plant src/b.rs <<< 'use crate::a::Inner; pub struct B; fn f(_: Inner) {}'
check "a circle through a re-export is found" finds 'circle of oleo-interface::a, oleo-interface::b'

plant src/b.rs <<< 'pub struct B;'
check "a re-export is no circle" python3 tests/harness/modules.py "$planted"
plant src/a/inner.rs <<< 'pub struct Inner(super::Own);'
plant src/a.rs <<< 'mod inner; pub use inner::Inner; pub struct Own; fn f(_: Inner) {}'
check "a module and its parent in a circle are found" finds 'circle of oleo-interface::a (own code), oleo-interface::a::inner'

rm -r "$planted/src"
crate oleo-controller oleo-hil
check "a dependency that points up is found" finds 'oleo-controller depends on oleo-hil, which is not below it'
crate oleo-controller oleo-interface
check "a dependency that points down is none" python3 tests/harness/modules.py "$planted"
exit 0
