"""Files that are likely to hold a secret, by their names."""

from __future__ import annotations

import re
from pathlib import PurePosixPath

_NAMES = re.compile(
    r"""
      (\.env|\.envrc)(\..*)? | .*\.env
    | [._]netrc | \.(pypirc|npmrc|yarnrc|pgpass|htpasswd|git-credentials|my\.cnf|s3cfg|boto|dockercfg)
    | id_(rsa|dsa|ecdsa|ed25519)(_sk)? | .*\.(pem|key|p12|pfx|jks|keystore|kdbx|ppk|asc|gpg|ovpn)
    | \.?(secrets?|credentials?|passwords?|passwd)([._-].*)?
    | .*[._-](secrets?|credentials?|passwords?)(\..*)?
    | service[_-]?account.*\.json | rootkey\.csv | kubeconfig
    """,
    re.VERBOSE | re.IGNORECASE,
)
#: folders in which tools keep what lets them in
_FOLDERS = {".ssh", ".aws", ".gnupg", ".kube", ".azure", ".gcloud", ".docker", ".config"}
#: what is meant to be filled in
_SAMPLES = re.compile(r".*\.(example|sample|template|dist|pub)", re.IGNORECASE)


def may_be_secret(name: str) -> bool:
    """Whether a file of this name, relative to the project, is of the kind that holds secrets."""
    *folders, last = PurePosixPath(name).parts
    if _SAMPLES.fullmatch(last):
        return False
    return bool(_NAMES.fullmatch(last)) or not _FOLDERS.isdisjoint(folders)
