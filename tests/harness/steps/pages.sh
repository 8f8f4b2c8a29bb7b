#!/usr/bin/env bash
# opens every kind of page in Chromium: three widths, light and dark, no clipped text, a clean console
. tests/harness/lib.sh

need chromium chromium || { skip "pages in a browser" "chromium is not available"; exit 0; }
check "release build" cargo build "${FEATURES[@]}" --locked --quiet --release || exit 0
folder=$(mktemp -d)
check "pages in a browser" python3 tests/pages_in_browser.py "$CARGO_TARGET_DIR/release/oleo" "$(command -v chromium)" "$folder"
tail -n 1 "$log" | sed 's/^/   /'
rm -r "$folder"
exit 0
