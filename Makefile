# Gopura. `make help` lists the targets.
#
# The folders are the architecture, so the build follows them: every C file of a folder and its rooms
# goes into one archive, each program is its main file plus what it pulls from that archive, and each
# test_*.c below tests/ is a program of its own.

BUILD   ?= build
SAN     ?=
JOBS    ?= $(shell nproc)
WINDOW  ?= yes
MAKEFLAGS += --no-builtin-rules
ifeq ($(MAKELEVEL)$(filter clean,$(MAKECMDGOALS)),0) # unless the command line says otherwise
MAKEFLAGS += -j$(JOBS)
endif
unexport MAKEFLAGS # scripts that call make say for themselves how many jobs
comma   := ,

FOLDERS := base geometry format tuf board system render ui input sound storage net app pipeline curator health
LIBS    := egl glesv2 gbm libdrm libevdev sqlite3 libjpeg libpng libwebp libcurl libzstd libsodium \
           pangocairo glib-2.0 libxml-2.0 libcjson sdl2 assimp libsystemd libmicrohttpd \
           libwebsockets libgit2 opusfile ogg alsa libcrypto zlib
# METIS, meshoptimizer and jsmn (only a header) have no pkg-config file in Debian 12.
EXTRA   := -lmetis -lmeshoptimizer -lm -pthread

# Evaluated lazily and once, because the `deps` target may install the packages first.
PKG_CFLAGS = $(eval PKG_CFLAGS := $(shell pkg-config --cflags $(LIBS)))$(PKG_CFLAGS)
PKG_LIBS   = $(eval PKG_LIBS := $(shell pkg-config --libs $(LIBS)))$(PKG_LIBS)

VERSION := $(shell git describe --always --dirty 2>/dev/null || echo unknown)
CC      := $(if $(shell command -v ccache),ccache )gcc
CXX     := $(if $(shell command -v ccache),ccache )g++
WARN    := -Wall -Wextra -Werror -Wshadow -Wstrict-prototypes -Wmissing-prototypes -Wpointer-arith
# Loops over three coordinates are everywhere: peeled, they are straight code. Nobody asks for errno or traps of
# mathematics; results are the same bits.
OPT     := -O2 -fpeel-loops -fno-math-errno -fno-trapping-math -g
CFLAGS   = -std=c11 -D_GNU_SOURCE -I. $(WARN) $(OPT) -ffp-contract=off -MMD -MP $(PKG_CFLAGS)
LDFLAGS  = -Wl,--as-needed
ifneq ($(SAN),)
# Uninitialised locals get the same wrong bits in every run, so a read of one is always found.
OPT     := -O1 -g1 -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer \
           -ftrivial-auto-var-init=pattern
endif

# tests/fuzz/main.c runs a fuzz target over its corpus; FUZZER=yes links it with clang's libFuzzer instead.
# COVERAGE=yes has the targets count which lines they reach.
FUZZ_MAIN = $(BUILD)/obj/tests/fuzz/main.o
ifneq ($(FUZZER)$(COVERAGE),)
CC      := $(if $(shell command -v ccache),ccache )clang
WARN    := $(filter-out -Werror,$(WARN)) # clang's warnings are not gcc's, which keeps the code clean
endif
ifneq ($(COVERAGE),)
OPT     := -O1 -g1 -fprofile-instr-generate -fcoverage-mapping
endif
ifneq ($(FUZZER),)
OPT     := -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer \
           -ftrivial-auto-var-init=pattern
FUZZ_MAIN =
$(BUILD)/tests/fuzz/fuzz_%: EXTRA += -fsanitize=fuzzer
endif

MAINS    := app/main.c net/main.c pipeline/main.c health/main.c system/main.c curator/main.c
SOURCES  := $(filter-out $(MAINS),$(shell find $(FOLDERS) -name '*.c' | sort))
ifneq ($(WINDOW),yes) # an appliance has no desktop, and no room for what SDL brings along
LIBS     := $(filter-out sdl2,$(LIBS))
CFLAGS   += -DGOPURA_NO_WINDOW
endif
OBJECTS  := $(SOURCES:%.c=$(BUILD)/obj/%.o)
ARCHIVE  := $(BUILD)/libgopura.a
PROGRAMS := $(BUILD)/gopura-content $(BUILD)/gopura-kiosk $(BUILD)/gopura-fetch $(BUILD)/gopura-health \
            $(BUILD)/gopura-setup $(BUILD)/gopura-curator
TEST_SOURCES := $(shell find tests -name 'test_*.c' | sort)
TESTS    := $(TEST_SOURCES:%.c=$(BUILD)/%)
TEST_OBJECTS := $(patsubst %.c,$(BUILD)/obj/%.o,$(shell find tests -name '*.c'))
FUZZ     := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/fuzz/fuzz_*.c))
SHIMS    := tests/tools/weak_gl tests/tools/lost_gl tests/tools/sick tests/tools/failing_calls tests/tools/set_clock \
            tests/tools/virtual_clock tests/tools/count_instructions
TOOLS    := $(patsubst %.c,$(BUILD)/%,$(filter-out $(SHIMS:%=%.c),$(wildcard tests/tools/*.c)))
CATALOGUES := $(patsubst ui/po/%.po,$(BUILD)/locale/%/LC_MESSAGES/gopura.mo,$(wildcard ui/po/*.po))
BENCH_PARTS := $(patsubst %,$(BUILD)/obj/tests/bench/%.o,stage visit hand shown)
BENCHES  := $(patsubst %.c,$(BUILD)/%,$(wildcard tests/bench/bench_*.c))

.DEFAULT_GOAL := all
.PHONY: all help deps demo curator test check soak soak-year soak-night torture badinput pictures golden fuzz fuzz-coverage powercut interrupted image image-check qemu-test qemu arm64 unit unit-san check-style po format bench bench-full clean
.SECONDARY:

all: deps $(PROGRAMS) $(CATALOGUES) ## build the programs into build/

help: ## list the targets
	@grep -hE '^[a-z0-9-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/^([a-z0-9-]+):.*## /make \1\t/' | expand -t 20

deps: $(BUILD)/.deps

# Checked again only when the list changes; installs nothing that is there.
$(BUILD)/.deps: packages.txt
	@mkdir -p $(@D)
	@./deps.sh
	@touch $@

$(BUILD)/.test-deps: tests/tools.txt | $(BUILD)/.deps
	@./deps.sh tests/tools.txt
	@touch $@

demo: all ## build and show the demo temple (Ctrl-C ends it)
	@demo/run.sh

curator: all ## build, and serve the demo temple to a curator's browser (Ctrl-C ends it); TRIANGLES=1000000
	@demo/curator.sh $(TRIANGLES)

test: all $(BUILD)/.test-deps ## everything: build, unit, sanitizers, pictures, end-to-end, style, fuzz, QEMU; T=NAME: one, as T=test_cut or T=e2e/kiosk
	@tests/run.sh $(if $(T),only $(T),all)

check: all $(BUILD)/.test-deps ## the quick loop: format, include rules, unit tests under sanitizers
	@tests/run.sh quick

soak: all $(BUILD)/.test-deps ## random touches on the whole kiosk under sanitizers, EVENTS=20000 SEED=1 (a quarter of an hour)
	@EVENTS=$(or $(EVENTS),20000) SEED=$(or $(SEED),1) bash tests/e2e/monkey.sh

soak-year: all $(BUILD)/.test-deps ## a year of a terminal's days on a clock that is set forward (docs/life.md), DAYS=366 VISITS=1 (half an hour)
	@DAYS=$(or $(DAYS),366) START=2027-11-15 VISITS=$(or $(VISITS),1) WORK=build/year bash tests/e2e/year.sh

soak-night: all $(BUILD)/.test-deps ## the same programs for HOURS=8 of real time, with visitors and releases (docs/life.md)
	@HOURS=$(or $(HOURS),8) WORK=build/night bash tests/e2e/year.sh

torture: all $(BUILD)/.test-deps ## every allocation and every call on a file fails once, in each use of the programs (hours); USES="keys build" SAMPLES=N
	@SAMPLES=$(or $(SAMPLES),0) USES="$(USES)" bash tests/e2e/torture.sh

badinput: all $(BUILD)/.test-deps ## each of the 469 malformed and unusual files to every reader that could meet it
	@bash tests/e2e/badinput.sh all

pictures: all $(BUILD)/.test-deps ## 16 views of the half-size demo temple against the reference (minutes)
	@bash tests/e2e/pictures.sh all

golden: all $(BUILD)/.test-deps ## pictures of every state in four languages into build/golden/, compared with the reviewed ones; KEEP=yes keeps them
	@LANGUAGES="$(or $(LANGUAGES),en km ja ar)" STATES="$(STATES)" KEEP="$(KEEP)" bash tests/e2e/golden.sh

# image/arch.sh reads ARCH and BOARD from the environment, where make puts them if the command line has them.
IMAGE_DEPS = ./deps.sh image/tools.txt$(if $(filter arm64,$(ARCH))$(BOARD), && ./deps.sh image/tools-arm64.txt)

image: all ## the bootable disk image of a terminal, build/image/gopura.img; ARCH=arm64: build/image-arm64/gopura.img; BOARD=raspberry-pi: for a Pi 4
	@$(IMAGE_DEPS)
	@image/build.sh

image-check: all ## check that two builds of the image have the same slots
	@$(IMAGE_DEPS)
	@image/check.sh

fuzz: deps ## guided fuzzing under libFuzzer and sanitizers, TIME=60 seconds each, or RUNS=N runs; TARGET=NAME for one; KEEP=yes adds inputs that it found to the corpora
	@./deps.sh tests/fuzz/tools.txt
	@TIME="$(TIME)" RUNS="$(RUNS)" TARGET="$(TARGET)" KEEP="$(KEEP)" JOBS="$(JOBS)" tests/fuzz/run.sh

fuzz-coverage: deps ## lines and branches of each decoder that the fuzz targets' inputs reach, into build/coverage/; TARGET=NAME for one
	@./deps.sh tests/fuzz/tools.txt
	@TARGET="$(TARGET)" python3 tests/fuzz/coverage.py

powercut: all $(BUILD)/.test-deps ## power cuts: at every write of cache and state (minutes), and 100 of the appliance (hours); CUTS=N, SEED=N
	@$(if $(CUT),,$(MAKE) --no-print-directory $(BUILD)/tests/storage/test_powercut)
	@$(if $(CUT),,nice -n 10 $(BUILD)/tests/storage/test_powercut --all $(SEED))
	@CUTS=$(or $(CUTS),100) bash tests/qemu/powercut.sh system

interrupted: all $(BUILD)/.test-deps ## builds killed and out of disk at random moments, then resumed: the same release; KILLS=50 FULL=20 SEED=1
	@KILLS=$(or $(KILLS),50) FULL=$(or $(FULL),20) SEED=$(or $(SEED),1) bash tests/e2e/interrupted.sh
	@KILLS=20 SEED=$(or $(SEED),1) bash tests/e2e/publish.sh

qemu-test: all $(BUILD)/.test-deps ## test the image in QEMU: temple, tap, updates (good, tampered, blank, hanging), a gopura.conf on a stick, the choice of the disk, a disk that fails, changed bytes, Secure Boot, encrypted data; ARCH=arm64: temple, tap, updates, changed bytes and Secure Boot of that image; BOARD=raspberry-pi: its start
ifeq ($(BOARD),raspberry-pi)
	@bash tests/qemu/raspberry_pi.sh
else
	@bash tests/qemu/image.sh updates
	@[ "$(ARCH)" = arm64 ] || bash tests/qemu/disks.sh all
	@[ "$(ARCH)" = arm64 ] || bash tests/qemu/worn.sh
	@bash tests/qemu/loader.sh all
	@[ "$(ARCH)" = arm64 ] || bash tests/qemu/tpm.sh
endif

qemu: all ## boot the image in QEMU to try it out: in a window, or on a VNC screen
	@./deps.sh image/tools.txt
	@image/qemu.sh

arm64: all $(BUILD)/.test-deps ## cross-compile for arm64, run unit tests and a kiosk of it under qemu-user
	@bash tests/qemu/arm64.sh all

bench: all $(BUILD)/.test-deps ## measure into build/bench/NAME.json (BENCH=NAME for one)
	@tests/bench/run.sh $(BENCH)

bench-full: all $(BUILD)/.test-deps ## benchmarks that take hours: temples of 1, 6 and 18 million triangles, and a hierarchy of 100 million, into build/bench/
	@tests/bench/run.sh --full

check-style: $(BUILD)/.test-deps ## clang-format, the include table, house rules
	@tests/style/check.sh

po: deps ## bring the texts for translators (ui/po) up to date with the sources
	@ui/po/extract.sh >ui/po/gopura.pot
	@for language in ui/po/*.po; do msgmerge -q --update --backup=none "$$language" ui/po/gopura.pot || exit; done

format: $(BUILD)/.test-deps ## format the sources with clang-format
	@git ls-files -co --exclude-standard '*.c' '*.h' '*.cpp' | xargs clang-format -i

# The keys of images stay: no terminal that was made with them takes an update of others (docs/install.md).
clean: ## remove build/ (the demo content and its caches too), but not the keys of images
	[ ! -d $(BUILD) ] || find $(BUILD)/ -mindepth 1 -maxdepth 1 ! -name image-keys -exec rm -rf {} +
	@[ ! -e $(BUILD)/image-keys ] || echo "$(BUILD)/image-keys stays: without it nobody can update its terminals"

# ---- build rules

$(BUILD)/obj/%.o: %.c | $(BUILD)/.deps
	@mkdir -p $(@D)
	@echo '  cc    $<'
	@$(CC) $(CFLAGS) -c $< -o $@

# Only files that print the version depend on it, so that a commit does not rebuild the tree.
$(patsubst %.c,$(BUILD)/obj/%.o,$(MAINS) app/settings/options.c): CFLAGS += -DGOPURA_VERSION='"$(VERSION)"'
# Loops over arrays of numbers, which the compiler turns into vector instructions.
VECTORS := geometry/substance pipeline/material/material $(addprefix pipeline/samples/,pyramid raster resolve)
$(VECTORS:%=$(BUILD)/obj/%.o): CFLAGS += -O3 -fno-math-errno -fno-trapping-math -Wno-psabi
# From neighbouring numbers, gcc 12 makes vectors in which (double)(float)x is not rounded. Spheres must be
# measured from the places that are stored.
$(BUILD)/obj/pipeline/hierarchy/%.o: CFLAGS += -fno-tree-slp-vectorize
# Kiosks decode patches all the time: with these loops unrolled, a fifth faster.
ifeq ($(SAN)$(FUZZER)$(COVERAGE),)
$(BUILD)/obj/format/patch.o $(BUILD)/obj/format/connectivity.o $(BUILD)/obj/format/predict.o $(BUILD)/obj/format/precision.o: OPT := -O3 -g
endif
# This one is also GLSL, whose constants are of single precision.
$(BUILD)/obj/geometry/substance.o: CFLAGS += -fsingle-precision-constant
$(TEST_OBJECTS): | $(BUILD)/.test-deps
$(BUILD)/obj/tests/%.o: CFLAGS += -DTEST_LOCALE='"$(BUILD)/locale"'
# The tests' own sources are compiled and linked as fast as possible; the product's sources are as in the field.
ifeq ($(FUZZER),)
$(BUILD)/obj/tests/%.o: OPT := $(patsubst -O%,-O0,$(OPT))
# But those of pictures compute what they compare with.
$(BUILD)/obj/tests/bench/%.o $(BUILD)/obj/tests/tools/%.o $(BUILD)/obj/tests/render/%.o: OPT := $(OPT)
endif
$(BUILD)/tests/%: LDFLAGS += -fuse-ld=gold

ifeq ($(WINDOW),yes)
$(ARCHIVE): $(OBJECTS)
	@rm -f $@
	@ar rcs $@ $^
else # the objects of the folder that this one is in, but for those that know of the window
BESIDE = $(patsubst %/,%,$(dir $(BUILD)))
$(ARCHIVE): $(BUILD)/obj/render/display/display.o $(BESIDE)/libgopura.a
	@cp $(BESIDE)/libgopura.a $@
	@ar d $@ display_window.o
	@ar rs $@ $<

$(BESIDE)/libgopura.a: FORCE
	@$(MAKE) --no-print-directory WINDOW=yes BUILD=$(BESIDE) CC="$(CC)" $@
FORCE:
endif

LINK = @echo '  link  $@' && $(CC) $(OPT) $(LDFLAGS) -o $@ $(filter %.o,$^) $(ARCHIVE) $(PKG_LIBS) $(EXTRA)

$(BUILD)/locale/%/LC_MESSAGES/gopura.mo: ui/po/%.po | $(BUILD)/.deps
	@mkdir -p $(@D)
	@msgfmt -c -o $@ $<

$(BUILD)/gopura-content: $(BUILD)/obj/pipeline/main.o $(ARCHIVE)
	$(LINK)
$(BUILD)/gopura-kiosk: $(BUILD)/obj/app/main.o $(ARCHIVE) | $(CATALOGUES)
	$(LINK)
$(BUILD)/gopura-fetch: $(BUILD)/obj/net/main.o $(ARCHIVE)
	$(LINK)
$(BUILD)/gopura-health: $(BUILD)/obj/health/main.o $(ARCHIVE)
	$(LINK)
$(BUILD)/gopura-setup: $(BUILD)/obj/system/main.o $(ARCHIVE)
	$(LINK)
$(BUILD)/gopura-curator: $(BUILD)/obj/curator/main.o $(ARCHIVE)
	$(LINK)
# The pages of a curator's browser, as they are and zipped, are part of the program.
$(BUILD)/obj/curator/server/web_files.o: $(patsubst %,$(BUILD)/obj/%.gz,$(wildcard curator/web/*))
$(BUILD)/obj/curator/server/web_files.o: CFLAGS += -Wa,-I$(BUILD)/obj
$(BUILD)/obj/curator/web/%.gz: curator/web/%
	@mkdir -p $(@D)
	@gzip -9nc $< >$@.part && mv $@.part $@

# A test may define a function of the archive itself; its own object has priority.
$(BUILD)/tests/fuzz/fuzz_%: $(BUILD)/obj/tests/fuzz/fuzz_%.o $(FUZZ_MAIN) $(ARCHIVE)
	@mkdir -p $(@D)
	$(LINK)
$(BUILD)/tests/bench/%: EXTRA += -Wl,--wrap=clock_now_us,--wrap=clock_now_ms
$(BUILD)/tests/bench/bench_materials: EXTRA += -lcmocka
$(BUILD)/tests/bench/bench_page: EXTRA += $(addprefix -Wl$(comma)--wrap=,frame_draw fingers_on_touch overlay_update)
$(BUILD)/tests/bench/%: $(BUILD)/obj/tests/bench/%.o $(BENCH_PARTS) $(ARCHIVE) | $(CATALOGUES)
	@mkdir -p $(@D)
	$(LINK)
$(BUILD)/tests/render/scene/test_scene: EXTRA += -Wl,--wrap=map_set
$(BUILD)/tests/app/test_fingers: EXTRA += -Wl,--wrap=scene_pick,--wrap=scene_part
$(BUILD)/tests/storage/test_powercut: EXTRA += $(addprefix -Wl$(comma)--wrap=,mkostemp write fsync close rename unlink)
$(BUILD)/tests/storage/test_state: EXTRA += -Wl,--wrap=open,--wrap=realloc
$(BUILD)/tests/pipeline/content/test_scan_surface: EXTRA += -Wl,--wrap=fsync
$(BUILD)/tests/pipeline/release/test_publish: EXTRA += -Wl,--wrap=fsync,--wrap=rename
$(BUILD)/tests/pipeline/release/test_renewal: EXTRA += -Wl,--wrap=clock_wall_s
$(BUILD)/tests/pipeline/keys/test_keys $(BUILD)/tests/pipeline/keys/test_keys_exchange: EXTRA += $(addprefix -Wl$(comma)--wrap=,mkdir write fsync rename)
$(BUILD)/tests/tools/hurried_kiosk: EXTRA += $(addprefix -Wl$(comma)--wrap=,clock_now_us clock_now_ms epoll_wait timerfd_settime frame_draw gl_place_bind gl_target_bind fingers_on_touch)
$(BUILD)/tests/curator/store/test_documents: EXTRA += -Wl,--wrap=rename,--wrap=fsync
$(BUILD)/tests/app/modes/test_self_test: EXTRA += $(addprefix -Wl$(comma)--wrap=,display_present display_ready display_take_stale)
$(BUILD)/tests/render/display/test_drm_card: EXTRA += -Wl,--wrap=open
$(BUILD)/tests/system/test_disk_table: EXTRA += -Wl,--wrap=pwrite,--wrap=fsync
$(BUILD)/tests/%: $(BUILD)/obj/tests/%.o $(ARCHIVE) | $(CATALOGUES)
	@mkdir -p $(@D)
	$(LINK) -lcmocka

# Libraries that tests preload, or that QEMU loads; part of no program.
$(SHIMS:%=$(BUILD)/%.so): $(BUILD)/%.so: %.c | $(BUILD)/.deps
	@mkdir -p $(@D)
	@echo '  link  $@'
	@$(CC) $(CFLAGS) -shared -fPIC $< -o $@ -ldl

fuzzers: $(FUZZ)
tests: $(TESTS) $(FUZZ) $(TOOLS) $(SHIMS:%=$(BUILD)/%.so)
benches: $(BENCH_PARTS) $(BENCHES)
.PHONY: tests fuzzers benches

-include $(shell find $(BUILD)/obj -name '*.d' 2>/dev/null)
