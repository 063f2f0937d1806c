from tests.runtime.conftest import make_stage

__all__ = ["make_stage"]
