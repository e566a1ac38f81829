# Two commands matter to a newcomer: `make serve` and `make test`. `make help` lists the rest.
# Needs make and Python 3.11 or newer; everything else goes into .venv.

# Plain assignments on purpose: some shells export HOST, and that must not decide where the service
# listens. `make serve HOST=... PORT=...` still wins, and PLUMBLINE_HOST and PLUMBLINE_PORT are honoured.
HOST =
PORT =
PYTHON =
PYTEST_ARGS =
IMAGE = plumbline
BASE =
ENGINE =
IMAGE_ARGS =

VENV := .venv
BIN := $(VENV)/bin
PIP_INSTALL := $(BIN)/python -m pip install --disable-pip-version-check -c constraints.txt

.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
.SUFFIXES:
.PHONY: help serve test lint format bench openapi docs figures constraints image clean distclean

help: ## list the commands
	@awk -F ':.*## ' '/^[a-z]+:.*## / { printf "  make %-12s %s\n", $$1, $$2 }' Makefile

serve: $(VENV)/.installed-service ## install what is missing, compile the kernels, start the service on 127.0.0.1:8000
	@PLUMBLINE_LOG_FORMAT="$${PLUMBLINE_LOG_FORMAT:-console}" exec $(BIN)/plumbline serve $(if $(HOST),--host "$(HOST)") $(if $(PORT),--port "$(PORT)")

test: lint ## install what the tests need and run all of them
	$(BIN)/plumbline warm
	$(BIN)/python -m pytest -n auto --dist loadgroup $(PYTEST_ARGS)

lint: $(VENV)/.installed-all ## static checks: ruff, mypy --strict, import contracts
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports --no-logo

format: $(VENV)/.installed-all ## let ruff sort the imports and format the code
	$(BIN)/ruff check --select I --fix .
	$(BIN)/ruff format .

bench: $(VENV)/.installed-all ## Plumbline beside its peers on the same data: rewrites docs/benchmarks.md
	$(BIN)/python -m benchmarks

openapi: $(VENV)/.installed-all ## rewrite openapi/openapi.json from the application
	$(BIN)/python -m service.openapi

docs: $(VENV)/.installed-all ## run every example of README.md and docs/ and rewrite outputs and generated tables
	$(BIN)/python -m tests.docs.refresh

figures: $(VENV)/.installed-all ## draw the pictures of the documentation
	$(BIN)/python -m examples.figures

constraints: $(VENV)/.installed-all ## pin the versions that are installed now
	$(BIN)/python -m tests.project.closure --write

# Images in the OCI format hold no health check; docker writes its own format and knows no other.
image: ## build the container image `plumbline` with docker, podman or buildah
	@for engine in $(if $(ENGINE),"$(ENGINE)",docker podman buildah); do \
	  if command -v "$$engine" >/dev/null; then \
	    if [ "$$engine" != docker ]; then format="--format=docker"; else format=; fi; \
	    exec "$$engine" build $$format $(if $(BASE),--build-arg BASE="$(BASE)") $(IMAGE_ARGS) -t "$(IMAGE)" .; \
	  fi; \
	done; \
	echo "No docker, podman or buildah was found to build the image with." >&2; \
	exit 1

clean: ## remove caches, compiled kernels among them
	find . -name __pycache__ -type d -not -path './$(VENV)/*' -prune -exec rm -rf {} +
	rm -rf .mypy_cache .ruff_cache .pytest_cache .hypothesis .import_linter_cache build dist

distclean: clean ## clean, and remove the environment
	rm -rf $(VENV)

# The environment. Stamps say what is installed; everything contains what the service needs.

$(BIN)/python:
	@found=; \
	for candidate in $(if $(PYTHON),"$(PYTHON)",python3 python3.14 python3.13 python3.12 python3.11); do \
	  if "$$candidate" -c 'import sys; sys.exit(sys.version_info < (3, 11))' >/dev/null 2>&1; then \
	    found=$$candidate; break; \
	  fi; \
	done; \
	if [ -z "$$found" ]; then \
	  echo "Plumbline needs Python 3.11 or newer, and none was found." >&2; \
	  echo "Name one: make serve PYTHON=/path/to/python3.12" >&2; \
	  exit 1; \
	fi; \
	if ! "$$found" -c 'import ensurepip, venv' >/dev/null 2>&1; then \
	  echo "$$found has no venv module. On Debian and Ubuntu: apt-get install python3-venv" >&2; \
	  exit 1; \
	fi; \
	echo "Creating $(VENV) with $$("$$found" --version)"; \
	"$$found" -m venv $(VENV)

$(VENV)/.installed-service: $(BIN)/python pyproject.toml constraints.txt
	$(PIP_INSTALL) -e '.[service,pandas]'
	@touch $@

$(VENV)/.installed-all: $(BIN)/python pyproject.toml constraints.txt
	$(PIP_INSTALL) -e '.[bench]'
	@touch $(VENV)/.installed-service $@
