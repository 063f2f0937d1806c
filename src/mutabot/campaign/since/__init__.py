"""What has changed since a revision, and which mutants that can have altered."""
