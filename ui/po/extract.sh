#!/bin/bash
# ui/po/extract.sh: prints the template of the kiosk's texts (gopura.pot), read off the sources. With no date in it,
# the same sources give the same template.
set -eu
cd "$(dirname "$0")/../.."
# shellcheck disable=SC2046
xgettext --language=C --from-code=UTF-8 --keyword= --keyword=N_ --keyword=translate:2 --keyword=translate_plural:2,3 \
	--add-comments='Translators:' --add-location=file --sort-by-file --package-name=Gopura -o - \
	$(git ls-files -co --exclude-standard 'ui/*.c' | sort) |
	sed -e '1,4d' -e '/^"POT-Creation-Date:/d' -e 's/charset=CHARSET/charset=UTF-8/'
