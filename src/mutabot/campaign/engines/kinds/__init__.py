"""The engines, one file each, which sets ``ENGINE``."""
