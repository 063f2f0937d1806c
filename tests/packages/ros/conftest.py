from tests.inside.conftest import make_stage as make_stage
